use std::ffi::{c_char, c_int, c_uint};

use super::memory::{bytes, input, output, output_text, text};
use super::runtime::{code, enter};

#[unsafe(no_mangle)]
extern "C" fn SERInit(port: c_int, baud: c_int, _handshake: c_int) -> c_int {
    code(enter("SERInit", |robios| robios.ser_init(port, baud)))
}

#[unsafe(no_mangle)]
extern "C" fn SERSendChar(port: c_int, letter: c_char) -> c_int {
    code(enter("SERSendChar", |robios| robios.ser_send(port, &[letter as u8])))
}

/// Sends a zero-terminated text.
#[unsafe(no_mangle)]
extern "C" fn SERSend(port: c_int, message: *const c_char) -> c_int {
    code(bytes(message).and_then(|message| enter("SERSend", |robios| robios.ser_send(port, message))))
}

/// Variant with a length, to which the header redirects such calls.
#[unsafe(no_mangle)]
extern "C" fn eyesim_SERSendN(port: c_int, message: *const u8, length: c_uint) -> c_int {
    let message = input(message, length as usize);
    code(message.and_then(|message| enter("SERSend", |robios| robios.ser_send(port, message))))
}

/// Returns 0 if nothing is waiting.
#[unsafe(no_mangle)]
extern "C" fn SERReceiveChar(port: c_int) -> c_char {
    let letter = enter("SERReceiveChar", |robios| robios.ser_receive(port, 1));
    letter.and_then(|data| data.first().copied()).unwrap_or(0) as c_char
}

/// Maximum number of bytes received without a given size, including the terminating zero byte.
const UNSIZED: usize = 128;

/// Returns the number of bytes received.
#[unsafe(no_mangle)]
extern "C" fn SERReceive(port: c_int, buffer: *mut c_char) -> c_int {
    eyesim_SERReceiveN(port, buffer, UNSIZED as c_int)
}

/// Variant with a size, to which the header redirects such calls.
#[unsafe(no_mangle)]
extern "C" fn eyesim_SERReceiveN(port: c_int, buffer: *mut c_char, size: c_int) -> c_int {
    let room = usize::try_from(size).unwrap_or(0).saturating_sub(1);
    if buffer.is_null() || size < 1 {
        return 0;
    }
    let data = enter("SERReceive", |robios| robios.ser_receive(port, room)).unwrap_or_default();
    output_text(buffer, &data, room + 1);
    data.len() as c_int
}

#[unsafe(no_mangle)]
extern "C" fn SERCheck(port: c_int) -> c_int {
    enter("SERCheck", |robios| robios.ser_check(port)).unwrap_or(0)
}

#[unsafe(no_mangle)]
extern "C" fn SERFlush(port: c_int) -> c_int {
    code(enter("SERFlush", |robios| robios.ser_flush(port)))
}

#[unsafe(no_mangle)]
extern "C" fn SERClose(port: c_int) -> c_int {
    code(enter("SERClose", |robios| robios.ser_close(port)))
}

#[unsafe(no_mangle)]
extern "C" fn DIGITALSetup(line: c_int, direction: c_char) -> c_int {
    code(enter("DIGITALSetup", |robios| robios.digital_setup(line, direction as u8)))
}

#[unsafe(no_mangle)]
extern "C" fn DIGITALRead(line: c_int) -> c_int {
    enter("DIGITALRead", |robios| robios.digital_read(line)).unwrap_or(0)
}

#[unsafe(no_mangle)]
extern "C" fn DIGITALReadAll() -> c_int {
    enter("DIGITALReadAll", |robios| robios.digital_read_all()).unwrap_or(0)
}

#[unsafe(no_mangle)]
extern "C" fn DIGITALWrite(line: c_int, state: c_int) -> c_int {
    code(enter("DIGITALWrite", |robios| robios.digital_write(line, state)))
}

#[unsafe(no_mangle)]
extern "C" fn ANALOGRead(channel: c_int) -> c_int {
    enter("ANALOGRead", |robios| robios.analog_read(channel)).unwrap_or(0)
}

#[unsafe(no_mangle)]
extern "C" fn ANALOGVoltage() -> c_int {
    enter("ANALOGVoltage", |robios| robios.analog_voltage()).unwrap_or(0)
}

#[unsafe(no_mangle)]
extern "C" fn ANALOGRecord(channel: c_int, samples: c_int) -> c_int {
    code(enter("ANALOGRecord", |robios| robios.analog_record(channel, samples)))
}

/// Returns the number of samples.
#[unsafe(no_mangle)]
extern "C" fn ANALOGTransfer(buffer: *mut u8) -> c_int {
    let samples = enter("ANALOGTransfer", |robios| robios.analog_transfer()).unwrap_or_default();
    if output(buffer, &samples) { samples.len() as c_int } else { 0 }
}

#[unsafe(no_mangle)]
pub(super) extern "C" fn AUBeep() -> c_int {
    code(enter("AUBeep", |robios| robios.au_beep()))
}

#[unsafe(no_mangle)]
extern "C" fn AUPlay(sample: *const c_char) -> c_int {
    code(text(sample).and_then(|sample| enter("AUPlay", |robios| robios.au_play(&sample))))
}

#[unsafe(no_mangle)]
pub(super) extern "C" fn AUDone() -> c_int {
    c_int::from(enter("AUDone", |robios| robios.au_done()).unwrap_or(true))
}

/// There is no sound to record.
#[unsafe(no_mangle)]
extern "C" fn AUMicrophone() -> c_int {
    enter("AUMicrophone", |robios| robios.charge()).map_or(0, |()| 0)
}
