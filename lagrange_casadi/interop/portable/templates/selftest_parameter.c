  {
    ${p}_parameters parameters = ${p}_defaults;
    parameters.$parameter = (${p}_real) NAN;
    expect(${p}_prepare(&model, &parameters), ${P}_BAD_PARAMETER);
    expect(${p}_evaluate(&model, &inputs, &outputs), ${P}_NOT_PREPARED);
  }
