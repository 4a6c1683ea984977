//! A program's display for who watches: pixels and labels of the soft keys.

use std::fmt;
use std::io::{self, Read, Write};

use image::RgbImage;
use roverlab::io::sim::Lcd;

/// Interval between two states of the display (s).
const INTERVAL: f64 = 0.1;
/// Maximum length of the labels (bytes), and of a side of the display (pixels).
const LONGEST: usize = 4096;
const WIDEST: u32 = 4096;

/// Receives the pixels of a display and its labels.
type Show = dyn FnMut(&RgbImage, &str) -> io::Result<()> + Send;

/// Shows a display to who watches it.
pub struct Showing {
    watcher: Box<Show>,
    shown: Option<(RgbImage, String)>,
    due: f64,
}

impl fmt::Debug for Showing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Showing").field("due", &self.due).finish_non_exhaustive()
    }
}

impl Showing {
    /// Shows a display to a watcher.
    pub fn new(watcher: impl FnMut(&RgbImage, &str) -> io::Result<()> + Send + 'static) -> Self {
        Self { watcher: Box::new(watcher), shown: None, due: 0.0 }
    }

    /// Shows a display at the other end of a stream, where [`read`] reads it.
    pub fn through(mut stream: impl Write + Send + 'static) -> Self {
        Self::new(move |image, menu| write(&mut stream, image, menu))
    }

    /// Sends the display at a time (s), if it has changed and something is due.
    pub fn show(&mut self, lcd: &Lcd, time: f64) {
        if time < self.due {
            return;
        }
        let menu = lcd.menu().join("\n");
        let known =
            self.shown.as_ref().is_some_and(|(image, labels)| image == lcd.frame() && *labels == menu);
        self.due = time + INTERVAL;
        // Without a reader, nobody watches.
        if !known && (self.watcher)(lcd.frame(), &menu).is_ok() {
            self.shown = Some((lcd.frame().clone(), menu));
        }
    }

    /// Sends the last state of the display.
    pub fn show_last(&mut self, lcd: &Lcd) {
        self.show(lcd, f64::INFINITY);
    }
}

fn write(out: &mut impl Write, image: &RgbImage, menu: &str) -> io::Result<()> {
    let (width, height) = image.dimensions();
    let head = [menu.len() as u32, width, height].map(u32::to_le_bytes).concat();
    out.write_all(&[&head, menu.as_bytes(), image.as_raw()].concat())
}

/// Reads the next state of a display and its labels. Fails at the end, and for bytes that are none.
pub fn read(stream: &mut impl Read) -> io::Result<(RgbImage, String)> {
    let mut head = [0; 12];
    stream.read_exact(&mut head)?;
    let (words, _) = head.as_chunks::<4>();
    let [length, width, height] = [0, 1, 2].map(|index| u32::from_le_bytes(words[index]));
    let length = length as usize;
    if length > LONGEST || width > WIDEST || height > WIDEST {
        return Err(io::ErrorKind::InvalidData.into());
    }
    let mut menu = vec![0; length];
    stream.read_exact(&mut menu)?;
    let mut image = RgbImage::new(width, height);
    stream.read_exact(&mut image)?;
    Ok((image, String::from_utf8_lossy(&menu).into_owned()))
}

#[cfg(test)]
mod tests {
    use std::os::unix::net::UnixStream;

    use roverlab::io::Display;

    use super::*;

    #[test]
    fn what_has_changed_is_shown_when_it_is_due() {
        let (ours, mut theirs) = UnixStream::pair().unwrap();
        // The display is larger than the socket's buffer.
        let reader = std::thread::spawn(move || {
            let shown: Vec<_> = std::iter::from_fn(|| read(&mut theirs).ok()).collect();
            shown
        });
        let (mut showing, mut lcd) = (Showing::through(ours), Lcd::default());
        lcd.set_menu(["A", "", "", "END"]).unwrap();
        showing.show(&lcd, 0.0);
        lcd.print("hello").unwrap();
        showing.show(&lcd, 0.05);
        showing.show(&lcd, 0.2);
        showing.show(&lcd, 0.4);
        lcd.print("end").unwrap();
        showing.show_last(&lcd);
        drop(showing);
        let shown = reader.join().unwrap();
        assert_eq!(shown.len(), 3);
        assert_eq!(shown[0].1, "A\n\n\nEND");
        assert_eq!(shown[2].0, *lcd.frame());
        assert!(read(&mut &[255; 100][..]).is_err());
    }
}
