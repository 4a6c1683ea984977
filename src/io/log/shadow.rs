use image::RgbImage;

use super::stamp::Nanoseconds;
use crate::io::Lcd;
use crate::io::Result;

/// What a recorded robot's display shows, drawn once more for viewers.
///
/// It is shown at most once a second of the robot's time, when something has been drawn since.
#[derive(Debug, Default)]
pub(super) struct Shadow {
    lcd: Option<Box<Lcd>>,
    /// The second in which something was drawn that has not been shown.
    dirty: Option<u64>,
}

/// Nanoseconds of a second.
const SECOND: Nanoseconds = 1_000_000_000;

impl Shadow {
    /// Whether the display is to be shown before what comes at a time.
    pub(super) fn is_due(&self, time: Nanoseconds) -> bool {
        self.dirty.is_some_and(|second| time / SECOND > second)
    }

    /// What the display shows, if something has been drawn since the last time.
    pub(super) fn take(&mut self) -> Option<&RgbImage> {
        self.dirty.take()?;
        self.lcd.as_deref().map(Lcd::frame)
    }

    /// Draws what the robot drew at a time.
    pub(super) fn draw(&mut self, time: Nanoseconds, drawing: impl FnOnce(&mut Lcd) -> Result<()>) {
        let lcd = self.lcd.get_or_insert_with(|| Box::new(Lcd::new()));
        // What the robot's own display accepted may not fit this one; then it is not shown.
        if drawing(lcd).is_ok() {
            self.dirty = self.dirty.or(Some(time / SECOND));
        }
    }
}
