//! Whatever the reader accepts, it must read again from its own writer's text.
#![no_main]

use libfuzzer_sys::fuzz_target;
use roverlab::world::formats::wld;

fuzz_target!(|text: &str| {
    let Ok(parsed) = wld::parse(text, "fuzz.wld") else { return };
    let again = wld::parse(&wld::print(&parsed.value), "fuzz.wld").expect("the writer's text reads");
    assert_eq!(again.value, parsed.value);
});
