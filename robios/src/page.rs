//! The robot of a program in a page: RoBIOS's functions are the module's.

use crate::ffi::runtime;
use crate::robios::Robios;

/// Gives the page's program a robot.
pub fn begin(robios: Robios) {
    runtime::begin(robios);
}

/// Ends the robot's run: it drives on until it stands, and its report is written.
pub fn finish() {
    runtime::finish();
}
