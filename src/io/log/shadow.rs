use image::RgbImage;

use super::stamp::Nanoseconds;
use crate::io::Lcd;
use crate::io::Result;

/// A copy of a recorded robot's display, for viewers.
///
/// It is written at most once per second of the robot's time, after changes.
#[derive(Debug, Default)]
pub(super) struct Shadow {
    lcd: Option<Box<Lcd>>,
    /// Second of the first drawing not yet written.
    dirty: Option<u64>,
}

/// Nanoseconds of a second.
const SECOND: Nanoseconds = 1_000_000_000;

impl Shadow {
    /// Whether the display is to be written before a message at this time.
    pub(super) fn is_due(&self, time: Nanoseconds) -> bool {
        self.dirty.is_some_and(|second| time / SECOND > second)
    }

    /// The display, if something was drawn since the last time.
    pub(super) fn take(&mut self) -> Option<&RgbImage> {
        self.dirty.take()?;
        self.lcd.as_deref().map(Lcd::frame)
    }

    /// Repeats the robot's drawing at a time.
    pub(super) fn draw(&mut self, time: Nanoseconds, drawing: impl FnOnce(&mut Lcd) -> Result<()>) {
        let lcd = self.lcd.get_or_insert_with(|| Box::new(Lcd::new()));
        // A drawing that the robot's own display accepted may fail here; then it is not shown.
        if drawing(lcd).is_ok() {
            self.dirty = self.dirty.or(Some(time / SECOND));
        }
    }
}
