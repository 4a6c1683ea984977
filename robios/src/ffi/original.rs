//! The C library's functions behind replacements of the same name.

use std::ffi::{CStr, c_void};
use std::ptr;
use std::sync::atomic::{AtomicPtr, Ordering};

/// A function of the C library, looked up at its first use.
#[derive(Debug)]
pub(super) struct Original {
    name: &'static CStr,
    found: AtomicPtr<c_void>,
}

impl Original {
    pub(super) const fn of(name: &'static CStr) -> Self {
        Self { name, found: AtomicPtr::new(ptr::null_mut()) }
    }

    /// Its address; `None` if the C library lacks it.
    pub(super) fn address(&self) -> Option<*mut c_void> {
        let mut found = self.found.load(Ordering::Relaxed);
        if found.is_null() {
            found = original(self.name);
            self.found.store(found, Ordering::Relaxed);
        }
        (!found.is_null()).then_some(found)
    }
}

/// The C library's function with this name, in the version that programs of today are linked with: those for
/// condition variables have an older one, of another type.
#[cfg(all(target_arch = "x86_64", target_env = "gnu"))]
pub(super) fn original(name: &CStr) -> *mut c_void {
    // SAFETY: name and version end with a zero byte.
    let newer = unsafe { libc::dlvsym(libc::RTLD_NEXT, name.as_ptr(), c"GLIBC_2.3.2".as_ptr()) };
    // SAFETY: the name ends with a zero byte.
    if newer.is_null() { unsafe { libc::dlsym(libc::RTLD_NEXT, name.as_ptr()) } } else { newer }
}

/// The C library's function with this name.
#[cfg(not(all(target_arch = "x86_64", target_env = "gnu")))]
pub(super) fn original(name: &CStr) -> *mut c_void {
    // SAFETY: the name ends with a zero byte.
    unsafe { libc::dlsym(libc::RTLD_NEXT, name.as_ptr()) }
}

/// Calls a function of the C library with arguments of these types; `ENOSYS` if it lacks it.
macro_rules! call_original {
    ($function:expr, $($argument:expr => $type:ty),+) => {
        match $function.address() {
            None => libc::ENOSYS,
            // SAFETY: the C library's function has this type; the arguments are the program's.
            Some(found) => unsafe {
                type Function = unsafe extern "C-unwind" fn($($type),+) -> std::ffi::c_int;
                std::mem::transmute::<*mut std::ffi::c_void, Function>(found)($($argument),+)
            },
        }
    };
}
pub(super) use call_original;
