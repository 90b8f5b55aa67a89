for (k = $start; k < $stop; ++k) {
  if (!(sound_of[k] $test 0 && is_finite(sound_of[k]))) return ${P}_BAD_PARAMETER;
}
