//! Efforts of open chains by dynibo's recursion.
use dynibo::Robot;
use std::ffi::{CStr, c_char};
use std::slice::{from_raw_parts, from_raw_parts_mut};

/// # Safety
/// `urdf` is the path of a file, as a text that ends with zero.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn made(urdf: *const c_char) -> *mut Robot {
    let path = unsafe { CStr::from_ptr(urdf) }.to_str().unwrap();
    Box::into_raw(Box::new(Robot::from_urdf(path).unwrap()))
}

/// Efforts at instants, one after another; all arrays are (instants, joints).
///
/// # Safety
/// `robot` is what `made` gave, and the arrays have that size.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn efforts(
    robot: *mut Robot,
    instants: usize,
    q: *const f64,
    v: *const f64,
    a: *const f64,
    out: *mut f64,
) {
    let robot = unsafe { &mut *robot };
    let n = robot.generalized_count();
    let [q, v, a] = [q, v, a].map(|x| unsafe { from_raw_parts(x, n * instants) });
    let out = unsafe { from_raw_parts_mut(out, n * instants) };
    for i in (0..n * instants).step_by(n) {
        let now = i..i + n;
        let known = (&q[now.clone()], &v[now.clone()], &a[now.clone()]);
        robot.inverse_dynamics(known.0, known.1, known.2, &[], &mut out[now]).unwrap();
    }
}
