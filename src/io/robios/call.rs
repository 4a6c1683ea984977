//! Calls of the library's functions.

use std::ffi::c_int;

use crate::io::{Error, ErrorKind, Result};

/// Calls a function of the library and returns its result.
macro_rules! call {
    ($robot:expr, $name:ident($($argument:expr),*)) => {{
        let function = $robot.robios.$name()?;
        // SAFETY: the library is loaded, the arguments have the types of its header, and pointers refer to
        // memory that outlives the call and is as large as the function may write.
        unsafe { function($($argument),*) }
    }};
}

/// Calls a function that returns 0 on success.
macro_rules! order {
    ($robot:expr, $name:ident($($argument:expr),*)) => {{
        let code = $crate::io::robios::call::call!($robot, $name($($argument),*));
        $crate::io::robios::call::succeeded(stringify!($name), code)
    }};
}

pub(super) fn succeeded(name: &str, code: c_int) -> Result<()> {
    if code == 0 {
        return Ok(());
    }
    Err(Error::new(ErrorKind::Other, format!("{name} returned {code}; expected 0, the code of success")))
}

pub(super) use {call, order};
