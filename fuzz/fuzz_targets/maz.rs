//! Whatever the reader accepts, it must read again from its own writer's text.
#![no_main]

use libfuzzer_sys::fuzz_target;
use roverlab::world::formats::maz;

fuzz_target!(|text: &str| {
    let Ok(parsed) = maz::parse_maze(text, "fuzz.maz") else { return };
    let _ = parsed.value.to_world();
    let again = maz::parse_maze(&maz::print(&parsed.value), "fuzz.maz").expect("the writer's text reads");
    assert_eq!(again.value, parsed.value);
});
