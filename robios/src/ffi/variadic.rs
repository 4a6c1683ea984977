//! `LCDPrintf` and `LCDSetPrintf`: jumps to the functions in `shim.c` that format the text and pass it on.

use std::ffi::{c_char, c_int};

use super::memory::text;
use super::runtime::{code, enter};

#[cfg(not(target_family = "wasm"))]
mod jumps {
    use std::arch::naked_asm;
    use std::ffi::{c_char, c_int};

    unsafe extern "C" {
        fn eyesim_shim_printf(format: *const c_char, ...) -> c_int;
        fn eyesim_shim_set_printf(row: c_int, column: c_int, format: *const c_char, ...) -> c_int;
    }

    /// Exports a function of the shim under RoBIOS's name. The arguments stay where they are.
    macro_rules! jump {
        ($name:ident, $target:ident) => {
            #[unsafe(no_mangle)]
            #[unsafe(naked)]
            extern "C" fn $name() {
                #[cfg(any(target_arch = "x86_64", target_arch = "x86"))]
                naked_asm!("jmp {target}", target = sym $target);
                #[cfg(any(target_arch = "aarch64", target_arch = "arm"))]
                naked_asm!("b {target}", target = sym $target);
                #[cfg(any(target_arch = "riscv64", target_arch = "riscv32"))]
                naked_asm!("tail {target}", target = sym $target);
            }
        };
    }

    jump!(LCDPrintf, eyesim_shim_printf);
    jump!(LCDSetPrintf, eyesim_shim_set_printf);
}

#[unsafe(no_mangle)]
extern "C" fn eyesim_print(line: *const c_char) -> c_int {
    code(text(line).and_then(|line| enter("LCDPrintf", |robios| robios.lcd_print(&line))))
}

#[unsafe(no_mangle)]
extern "C" fn eyesim_print_at(row: c_int, column: c_int, line: *const c_char) -> c_int {
    code(text(line).and_then(|line| enter("LCDSetPrintf", |robios| robios.lcd_print_at(row, column, &line))))
}
