/* $name for controllers, in C++11: efforts of the drives from positions, rates and accelerations, and reflected inertia.
   Written by lagrange_casadi $version, scene $scene. Needs ${p}.h and ${p}.c, and nothing else; asks for no memory and throws
   nothing, so it may be called in an update of ros2_control.

     ${p}_control::Control control;
     if (control.configure() != ${P}_OK) ...
     control.efforts(q, dq, ddq, tau$time_given);

   Positions in the order of coordinates[], efforts in that of drives[]. What fails returns why, and leaves tau as it was. */
#ifndef ${P}_CONTROL_HPP
#define ${P}_CONTROL_HPP

#include <array>
#include <cstddef>

#include "${p}.h"

namespace ${p}_control {

constexpr std::size_t coordinates_count = $n_coordinates;
constexpr std::size_t drives_count = $n_drives;

/* Names as in the scene: of a joint, or of its coordinate. */
constexpr const char* coordinates[] = {$coordinates};
constexpr const char* drives[] = {$drives};

using Motion = std::array<double, coordinates_count>;
using Efforts = std::array<double, drives_count>;
using Inertia = std::array<std::array<double, coordinates_count>, drives_count>;

class Control {
 public:
  /* Makes the model ready; to be called once before all else, and again after a failure of iterated loops$or_between. */
  ${p}_status configure($parameters) {
$if closing
    begun_ = false;
$end closing
    return ${p}_prepare($prepare);
  }

  /* Efforts that make the motion, with all loads of the scene.$from_before */
  ${p}_status efforts(const Motion& q, const Motion& dq, const Motion& ddq, Efforts& tau$time) {
$if closing
    const ${p}_inputs inputs = given(q, dq, ddq$time_given);
    const ${p}_model before = model_;
    Efforts found;
    ${p}_status status = at(model_, inputs, found);
    if (status == ${P}_OK && begun_) status = ${p}_between(&model_, &last_, &inputs, 0);
    if (status != ${P}_OK) {
      model_ = before;
      return status;
    }
    last_ = inputs;
    begun_ = true;
    tau = found;
    return status;
$end closing
$if not closing
    return at(model_, given(q, dq, ddq$time_given), tau);
$end closing
  }

  /* How efforts grow with accelerations, d tau/d ddq: the inertia that each drive sees. Exact, for efforts are linear in
     accelerations, but where friction follows reactions. */
  ${p}_status reflected_inertia(const Motion& q, const Motion& dq, Inertia& inertia$time) const {
    Inertia found = {};
    Efforts still, moved;
    Motion ddq = {};
    ${p}_model model = model_;
    ${p}_status status = at(model, given(q, dq, ddq$time_given), still);
    for (std::size_t j = 0; j < coordinates_count && status == ${P}_OK; ++j) {
      ddq[j] = 1.0;
      status = at(model, given(q, dq, ddq$time_given), moved);
      for (std::size_t i = 0; i < drives_count && status == ${P}_OK; ++i) found[i][j] = moved[i] - still[i];
      ddq[j] = 0.0;
    }
    if (status == ${P}_OK) inertia = found;
    return status;
  }

  static const char* message(${p}_status status) { return ${p}_message(status); }

  /* The scene's own motion, as a reference. */
  ${p}_status motion(double time, Motion& q, Motion& dq, Motion& ddq) const {
    ${p}_inputs inputs = {};
    const ${p}_status status = ${p}_motion(&model_, $time_pair, &inputs);
    if (status != ${P}_OK) return status;
$from_inputs
    return status;
  }

 private:
  ${p}_model model_ = {};
$if closing
  ${p}_inputs last_ = {};
  bool begun_ = false;
$end closing

  static ${p}_inputs given(const Motion& q, const Motion& dq, const Motion& ddq$time) {
    ${p}_inputs inputs = {};
$to_inputs
    return inputs;
  }

  static ${p}_status at(${p}_model& model, const ${p}_inputs& inputs, Efforts& tau) {
    ${p}_outputs outputs;
    const ${p}_status status = ${p}_evaluate(&model, &inputs, &outputs);
    if (status != ${P}_OK) return status;
$to_efforts
    return status;
  }
};

}  // namespace ${p}_control

#endif
