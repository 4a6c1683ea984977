use std::ffi::{c_char, c_int, c_uchar};
use std::path::Path;
use std::ptr::NonNull;
use std::sync::atomic::{AtomicI32, Ordering};

use libloading::Library;

use crate::io::{Error, ErrorKind, LidarSettings, Result};

/// Declares the functions used, and their lookup.
macro_rules! functions {
    ($($name:ident: fn($($argument:ty),* $(; $more:tt)?) -> $result:ty;)*) => {
        /// The functions of a library, as far as present.
        #[allow(non_snake_case, reason = "RoBIOS's own names")]
        #[derive(Debug)]
        pub(super) struct Functions {
            $($name: Option<unsafe extern "C" fn($($argument),* $(, $more)?) -> $result>,)*
            /// The variable with the number of distances that `LIDARGet` writes.
            lidar_resolution: Option<NonNull<AtomicI32>>,
            /// Keeps functions and variable loaded.
            _library: Library,
        }

        impl Functions {
            fn find(library: Library) -> Self {
                // SAFETY: RoBIOS's variable of this name is an int, which lives as long as the library.
                let found = unsafe { library.get::<*mut AtomicI32>(b"LIDAR_RESOLUTION\0") };
                let lidar_resolution = found.ok().and_then(|symbol| NonNull::new(*symbol));
                Self {
                    lidar_resolution,
                    $(
                        // SAFETY: RoBIOS's functions have these types; a library with other functions of the
                        // same names cannot be detected.
                        $name: unsafe { library.get(concat!(stringify!($name), "\0").as_bytes()) }
                            .ok()
                            .map(|symbol| *symbol),
                    )*
                    _library: library,
                }
            }
        }

        $(functions!(@get $name ($($argument),* $(; $more)?) $result);)*
    };
    (@get $name:ident ($($argument:ty),* $(; $more:tt)?) $result:ty) => {
        impl Functions {
            /// The function, or an error that names it.
            #[allow(non_snake_case, reason = "RoBIOS's own names")]
            pub(super) fn $name(
                &self,
            ) -> Result<unsafe extern "C" fn($($argument),* $(, $more)?) -> $result> {
                self.$name.ok_or_else(|| missing(stringify!($name)))
            }
        }
    };
}

functions! {
    OSGetCount: fn() -> c_int;
    OSWait: fn(c_int) -> c_int;
    VWSetSpeed: fn(c_int, c_int) -> c_int;
    VWGetSpeed: fn(*mut c_int, *mut c_int) -> c_int;
    VWSetPosition: fn(c_int, c_int, c_int) -> c_int;
    VWGetPosition: fn(*mut c_int, *mut c_int, *mut c_int) -> c_int;
    VWStraight: fn(c_int, c_int) -> c_int;
    VWTurn: fn(c_int, c_int) -> c_int;
    VWCurve: fn(c_int, c_int, c_int) -> c_int;
    VWDrive: fn(c_int, c_int, c_int) -> c_int;
    VWRemain: fn() -> c_int;
    VWDone: fn() -> c_int;
    VWWait: fn() -> c_int;
    VWStalled: fn() -> c_int;
    PSDGet: fn(c_int) -> c_int;
    LIDARGet: fn(*mut c_int) -> c_int;
    LIDARSet: fn(c_int, c_int, c_int) -> c_int;
    CAMInit: fn(c_int) -> c_int;
    CAMGet: fn(*mut c_uchar) -> c_int;
    LCDSetPos: fn(c_int, c_int) -> c_int;
    LCDGetPos: fn(*mut c_int, *mut c_int) -> c_int;
    LCDSetColor: fn(c_int, c_int) -> c_int;
    LCDSetFont: fn(c_int, c_int) -> c_int;
    LCDSetFontSize: fn(c_int) -> c_int;
    LCDSetMode: fn(c_int) -> c_int;
    LCDClear: fn() -> c_int;
    LCDGetSize: fn(*mut c_int, *mut c_int) -> c_int;
    LCDPixel: fn(c_int, c_int, c_int) -> c_int;
    LCDGetPixel: fn(c_int, c_int) -> c_int;
    LCDLine: fn(c_int, c_int, c_int, c_int, c_int) -> c_int;
    LCDArea: fn(c_int, c_int, c_int, c_int, c_int, c_int) -> c_int;
    LCDCircle: fn(c_int, c_int, c_int, c_int, c_int) -> c_int;
    LCDImageSize: fn(c_int) -> c_int;
    LCDImageStart: fn(c_int, c_int, c_int, c_int) -> c_int;
    LCDImage: fn(*const c_uchar) -> c_int;
    LCDImageGray: fn(*const c_uchar) -> c_int;
    LCDImageBinary: fn(*const c_uchar) -> c_int;
    LCDMenu: fn(*const c_char, *const c_char, *const c_char, *const c_char) -> c_int;
    LCDMenuI: fn(c_int, *const c_char, c_int, c_int) -> c_int;
    LCDRefresh: fn() -> c_int;
    KEYGet: fn() -> c_int;
    KEYRead: fn() -> c_int;
    KEYReadXY: fn(*mut c_int, *mut c_int) -> c_int;
    RADIOInit: fn() -> c_int;
    RADIOGetID: fn() -> c_int;
    RADIOStatus: fn(*mut c_int) -> c_int;
    RADIOSend: fn(c_int, *const c_char) -> c_int;
    RADIOCheck: fn(*mut c_int) -> c_int;
    RADIOReceive: fn(*mut c_int, *mut c_char, c_int) -> c_int;
    MOTORDrive: fn(c_int, c_int) -> c_int;
    SERVOSet: fn(c_int, c_int) -> c_int;
    ENCODERRead: fn(c_int) -> c_int;
    ENCODERReset: fn(c_int) -> c_int;
    ANALOGRead: fn(c_int) -> c_int;
    LCDPrintf: fn(*const c_char; ...) -> c_int;
    SIMGetRobot: fn(c_int, *mut c_int, *mut c_int, *mut c_int, *mut c_int) -> ();
}

// SAFETY: the variable is only read atomically, and everything else may be sent.
unsafe impl Send for Functions {}

// SAFETY: as above; concurrent calls are the library's responsibility.
unsafe impl Sync for Functions {}

impl Functions {
    /// Number of distances that `LIDARGet` writes, if the library reports a valid one.
    pub(super) fn lidar_points(&self) -> Option<usize> {
        // SAFETY: the variable lives as long as the library, which is loaded.
        let points = unsafe { self.lidar_resolution?.as_ref() }.load(Ordering::Relaxed);
        usize::try_from(points).ok().filter(|points| (1..=LidarSettings::MAX_POINTS).contains(points))
    }

    /// Loads a library. Fails if it cannot be loaded or has no driving functions.
    pub(super) fn load(path: &Path) -> Result<Self> {
        // SAFETY: loading a library runs its initialisation; the user has chosen this library.
        let library = unsafe { Library::new(path) }.map_err(|error| {
            let message = format!("{}: no library that can be loaded", path.display());
            Error::new(ErrorKind::InvalidInput, message).with_source(error)
        })?;
        let functions = Self::find(library);
        functions.VWSetSpeed().and(functions.OSWait().map(|_| ())).map_err(|error| {
            let message = format!("{}: no library of RoBIOS", path.display());
            Error::new(ErrorKind::InvalidInput, message).with_source(error)
        })?;
        Ok(functions)
    }
}

fn missing(name: &str) -> Error {
    Error::new(ErrorKind::Unsupported, format!("the library has no function {name}"))
}
