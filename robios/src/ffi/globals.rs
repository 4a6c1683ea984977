//! Variables that programs read.

use std::sync::atomic::{AtomicI32, Ordering};

/// How many distances `LIDARGet` writes.
#[unsafe(no_mangle)]
static LIDAR_RESOLUTION: AtomicI32 = AtomicI32::new(360);

/// Robots' scanners differ: a program learns by this number how many points theirs has.
pub(super) fn publish_points(points: usize) {
    LIDAR_RESOLUTION.store(points as i32, Ordering::Relaxed);
}
