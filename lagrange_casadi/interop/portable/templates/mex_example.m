% MEX_EXAMPLE  $name over the motion of its scene. Run it in its folder, in MATLAB or in Octave.
if exist('${p}_mex', 'file') ~= 3
  build_mex();
end
t = $start + (0:12)*$step;
inputs = ${p}_mex('motion', t);
outputs = ${p}_mex(inputs);
bad = find(outputs.status, 1);
if ~isempty(bad)
  error('${p}: at %g s: %s', t(bad), ${p}_mex('message', outputs.status(bad)));
end
fprintf('%13s  %13s  %13s\n', 'time [s]', '$coordinate [$coordinate_unit]', '$output [$output_unit]');
fprintf('%13.6g  %13.6g  %13.6g\n', [t; inputs$coordinate_field; outputs$output_field]);
$if link
forces = ${p}_mex('section', outputs, '$link', linspace(0, 1, 5));
fprintf('largest bending moment of $link: %g N m\n', max(abs(forces.bending(:))));
$end link
$if setting
parameters = struct('$setting', 1.01*$default);
other = ${p}_mex(${p}_mex('motion', t, parameters), parameters);
fprintf('$output changes by at most %g $unit_in_format where $setting is 1 %% larger\n', ...
        max(abs(other$output_field - outputs$output_field)));
$end setting
$if not link
$if not setting

$end setting
$end link
