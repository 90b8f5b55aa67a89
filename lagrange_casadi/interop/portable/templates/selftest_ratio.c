  {
    ${p}_forces forces;
    expect(${p}_section(&model, &outputs, $link, (${p}_real) 1.5, &forces), ${P}_BAD_RATIO);
    expect(${p}_section(&model, &outputs, $link, (${p}_real) NAN, &forces), ${P}_BAD_RATIO);
    expect(${p}_section(&model, &outputs, (${p}_link) $links, (${p}_real) 0.5, &forces), ${P}_NO_LINK);
    if (forces.axial == forces.axial) complain("forces are left as they were where there is no link");
  }
