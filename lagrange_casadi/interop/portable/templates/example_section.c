    status = ${p}_section(&model, &outputs, $link, $half, &forces);
    if (status != ${P}_OK) return failed(status);
    printf("   %13.6g", (double) forces.bending);
