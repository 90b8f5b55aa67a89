function build_mex()
% BUILD_MEX  Compile ${p}_mex, for MATLAB or Octave, into the folder of this file.
  folder = fileparts(mfilename('fullpath'));
  files = {fullfile(folder, '${p}_mex.c'), fullfile(folder, '${p}.c'), ['-I' folder]};
  target = fullfile(folder, '${p}_mex');
  % A product and a sum round as written, and nobody reads errno.
  flags = '-std=c99 -ffp-contract=off -fno-math-errno';
  if exist('OCTAVE_VERSION', 'builtin')
    before = getenv('CFLAGS');
    restore = onCleanup(@() setenv('CFLAGS', before));
    setenv('CFLAGS', [strtrim(mkoctfile('-p', 'CFLAGS')) ' ' flags]);
    [text, failed] = mkoctfile('--mex', '-o', [target '.' mexext()], files{:});
    if failed
      error('${p}:build', '${p}: it does not compile: %s', text);
    end
  elseif ispc
    mex(files{:}, '-outdir', folder, '-output', '${p}_mex');
  else
    mex(['CFLAGS=$$CFLAGS ' flags], files{:}, '-outdir', folder, '-output', '${p}_mex');
  end
end
