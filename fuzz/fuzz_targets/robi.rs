//! Whatever the reader accepts, it must read again from its own writer's text.
#![no_main]

use libfuzzer_sys::fuzz_target;
use roverlab::world::formats::robi;

fuzz_target!(|text: &str| {
    let Ok(parsed) = robi::parse(text, "fuzz.robi") else { return };
    let again = robi::parse(&robi::print(&parsed.value), "fuzz.robi").expect("the writer's text reads");
    assert_eq!(again.value, parsed.value);
});
