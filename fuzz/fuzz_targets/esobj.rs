//! Whatever the reader accepts, it must read again from its own writer's text.
#![no_main]

use libfuzzer_sys::fuzz_target;
use roverlab::world::formats::esobj;

fuzz_target!(|text: &str| {
    let Ok(parsed) = esobj::parse(text, "fuzz.esobj") else { return };
    let again = esobj::parse(&esobj::print(&parsed.value), "fuzz.esobj").expect("the writer's text reads");
    assert_eq!(again.value, parsed.value);
});
