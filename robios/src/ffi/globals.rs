//! Variables read by programs.

use std::sync::atomic::{AtomicI32, Ordering};

/// Number of distances that `LIDARGet` writes.
#[unsafe(no_mangle)]
static LIDAR_RESOLUTION: AtomicI32 = AtomicI32::new(360);

/// Publishes the robot's number of lidar points to the program.
pub(super) fn publish_points(points: usize) {
    LIDAR_RESOLUTION.store(points as i32, Ordering::Relaxed);
}
