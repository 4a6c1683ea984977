use std::ffi::{c_char, c_int};

use roverlab::io::sim::TICK;

use super::memory::{bytes, output};
use super::runtime::{code, enter};
use super::sleep::{may_block, sleep_for};

#[unsafe(no_mangle)]
extern "C" fn RADIOInit() -> c_int {
    code(enter("RADIOInit", |robios| robios.charge()))
}

#[unsafe(no_mangle)]
extern "C" fn RADIORelease() -> c_int {
    code(enter("RADIORelease", |robios| robios.charge()))
}

#[unsafe(no_mangle)]
extern "C" fn RADIOGetID() -> c_int {
    enter("RADIOGetID", |robios| robios.charge().map(|()| robios.identity().id as i32)).unwrap_or(0)
}

#[unsafe(no_mangle)]
extern "C" fn RADIOSend(to: c_int, message: *const c_char) -> c_int {
    code(bytes(message).and_then(|message| enter("RADIOSend", |robios| robios.radio_send(to, message))))
}

/// Waiting time of one request (s); repeated until there is a message.
const PATIENCE: f64 = 1.0;

/// Returns the message's length, or 0 on failure. A zero byte follows where there is room.
#[unsafe(no_mangle)]
extern "C" fn RADIOReceive(from: *mut c_int, buffer: *mut c_char, size: c_int) -> c_int {
    let Some(room) = usize::try_from(size).ok().filter(|_| !buffer.is_null()) else { return 0 };
    let message = loop {
        let blocks = may_block();
        match enter("RADIOReceive", |robios| robios.radio_receive(if blocks { PATIENCE } else { 0.0 })) {
            Some(Some(message)) => break message,
            Some(None) if blocks || sleep_for("", TICK).is_some() => {}
            _ => return 0,
        }
    };
    let mut text: Vec<c_char> = message.data.iter().take(room).map(|&byte| byte as c_char).collect();
    let length = text.len();
    if length < room {
        text.push(0);
    }
    output(buffer, &text);
    // A program that ignores the sender may pass a null pointer.
    output(from, &[message.from as c_int]);
    length as c_int
}

#[unsafe(no_mangle)]
extern "C" fn RADIOCheck() -> c_int {
    c_int::from(enter("RADIOCheck", |robios| robios.radio_check()).flatten().is_some())
}

/// Variant with an argument, to which the header redirects such calls.
#[unsafe(no_mangle)]
extern "C" fn eyesim_RADIOCheckFrom(from: *mut c_int) -> c_int {
    let found = enter("RADIOCheck", |robios| robios.radio_check()).flatten();
    if let Some(id) = found {
        output(from, &[id as c_int]);
    }
    c_int::from(found.is_some())
}

#[unsafe(no_mangle)]
extern "C" fn RADIOStatus(ids: *mut c_int) -> c_int {
    let numbers = enter("RADIOStatus", |robios| robios.charge().and_then(|()| robios.robot_numbers()))
        .unwrap_or_default();
    let numbers: Vec<c_int> = numbers.into_iter().map(|number| number as c_int).collect();
    if output(ids, &numbers) { numbers.len() as c_int } else { 0 }
}
