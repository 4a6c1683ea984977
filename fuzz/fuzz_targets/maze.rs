//! A maze file of any format, which comes back from its writer; and each line an answer of the simulator mms.
#![no_main]

use libfuzzer_sys::fuzz_target;
use roverlab::maze::files::{parse, print};
use roverlab::maze::mms::MmsMouse;

fuzz_target!(|bytes: &[u8]| {
    if let Ok(read) = parse(bytes, "fuzz.maze")
        && let Ok(text) = print(&read.maze, read.format)
    {
        let again = parse(text.as_bytes(), "fuzz.maze").expect("the writer's maze reads");
        let size = |maze: &roverlab::maze::Maze| (maze.width(), maze.height());
        assert_eq!(size(&again.maze), size(&read.maze));
    }
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    let mut mouse = MmsMouse::new();
    let _ = mouse.step(None);
    for answer in text.lines().take(64) {
        let answer = mouse.awaits().then_some(answer);
        if mouse.step(answer).is_err() {
            return;
        }
    }
});
