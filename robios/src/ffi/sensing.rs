use std::ffi::c_int;

use super::globals::publish_points;
use super::memory::{output, scatter};
use super::runtime::{code, enter};

#[unsafe(no_mangle)]
extern "C" fn PSDGet(psd: c_int) -> c_int {
    enter("PSDGet", |robios| robios.psd_get(psd)).unwrap_or(0)
}

#[unsafe(no_mangle)]
extern "C" fn PSDGetRaw(psd: c_int) -> c_int {
    PSDGet(psd)
}

#[unsafe(no_mangle)]
extern "C" fn LIDARGet(distances: *mut c_int) -> c_int {
    let scan = enter("LIDARGet", |robios| robios.lidar_get());
    code(scan.filter(|scan| output(distances, scan)).map(|_| ()))
}

#[unsafe(no_mangle)]
extern "C" fn LIDARSet(range: c_int, tilt: c_int, points: c_int) -> c_int {
    let set = enter("LIDARSet", |robios| robios.lidar_set(range, tilt, points));
    if set.is_some() {
        publish_points(points as usize);
    }
    code(set)
}

/// Name of 2017.
#[unsafe(no_mangle)]
extern "C" fn SIMLaserScan(distances: *mut c_int) -> c_int {
    LIDARGet(distances)
}

/// Writes zeros if the thing does not exist.
fn place<const N: usize>(places: [*mut c_int; N], found: Option<[i32; N]>) {
    scatter(places, found.unwrap_or([0; N]));
}

#[unsafe(no_mangle)]
extern "C" fn SIMGetRobot(id: c_int, x: *mut c_int, y: *mut c_int, z: *mut c_int, phi: *mut c_int) {
    place([x, y, z, phi], enter("SIMGetRobot", |robios| robios.sim_get_robot(id)));
}

#[unsafe(no_mangle)]
extern "C" fn SIMSetRobot(id: c_int, x: c_int, y: c_int, z: c_int, phi: c_int) {
    enter("SIMSetRobot", |robios| robios.sim_set_robot(id, [x, y, z, phi]));
}

#[unsafe(no_mangle)]
extern "C" fn SIMGetObject(id: c_int, x: *mut c_int, y: *mut c_int, z: *mut c_int, phi: *mut c_int) {
    place([x, y, z, phi], enter("SIMGetObject", |robios| robios.sim_get_object(id)));
}

#[unsafe(no_mangle)]
extern "C" fn SIMSetObject(id: c_int, x: c_int, y: c_int, _z: c_int, phi: c_int) {
    enter("SIMSetObject", |robios| robios.sim_set_object(id, [x, y, phi]));
}

fn without_z([x, y, _, phi]: [i32; 4]) -> [i32; 3] {
    [x, y, phi]
}

/// Variant of 2017, to which the header redirects calls with four arguments.
#[unsafe(no_mangle)]
extern "C" fn eyesim_SIMGetObject4(id: c_int, x: *mut c_int, y: *mut c_int, phi: *mut c_int) {
    place([x, y, phi], enter("SIMGetObject", |robios| robios.sim_get_object(id)).map(without_z));
}

/// Variant of 2017, to which the header redirects calls with four arguments.
#[unsafe(no_mangle)]
extern "C" fn eyesim_SIMSetObject4(id: c_int, x: c_int, y: c_int, phi: c_int) {
    enter("SIMSetObject", |robios| robios.sim_set_object(id, [x, y, phi]));
}

#[unsafe(no_mangle)]
extern "C" fn SIMGetPose(x: *mut c_int, y: *mut c_int, phi: *mut c_int) {
    place([x, y, phi], enter("SIMGetPose", |robios| robios.sim_get_robot(0)).map(without_z));
}

#[unsafe(no_mangle)]
extern "C" fn SIMSetPose(x: c_int, y: c_int, phi: c_int) {
    enter("SIMSetPose", |robios| robios.sim_set_robot(0, [x, y, 0, phi]));
}

#[unsafe(no_mangle)]
extern "C" fn SIMGetRobotCount() -> c_int {
    enter("SIMGetRobotCount", |robios| robios.charge().map(|()| robios.identity().robots as i32)).unwrap_or(0)
}

#[unsafe(no_mangle)]
extern "C" fn SIMGetObjectCount() -> c_int {
    enter("SIMGetObjectCount", |robios| robios.charge().map(|()| robios.identity().objects as i32))
        .unwrap_or(0)
}
