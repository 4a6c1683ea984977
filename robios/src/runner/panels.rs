use std::collections::BTreeMap;
use std::io::{Read, Write};
use std::os::unix::net::UnixStream;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;

use crate::showing;
use roverlab::io::Key;
use roverlab_view::Face;
use roverlab_view::serve::Devices;

/// Displays and soft keys of the programs, for the page beside them. Copies share them.
#[derive(Debug, Clone, Default)]
pub(crate) struct Panels(Arc<Mutex<BTreeMap<usize, Panel>>>);

/// The panel of a robot.
#[derive(Debug, Default)]
struct Panel {
    /// Where keys are typed.
    keys: Option<UnixStream>,
    face: Option<Face>,
}

impl Panels {
    fn lock(&self) -> MutexGuard<'_, BTreeMap<usize, Panel>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Types the keys of a robot's program at this end of a socket.
    pub(crate) fn connect_keys(&self, robot: usize, stream: UnixStream) {
        self.lock().entry(robot).or_default().keys = Some(stream);
    }

    /// Shows the display that comes from this end of a socket, until it is closed.
    pub(crate) fn connect_display(&self, robot: usize, mut stream: impl Read + Send + 'static) {
        let panels = self.clone();
        thread::spawn(move || {
            let mut drawings = 0;
            while let Ok((image, menu)) = showing::read(&mut stream) {
                drawings += 1;
                let face = Face { drawings, image: Arc::new(image), menu };
                panels.lock().entry(robot).or_default().face = Some(face);
            }
        });
    }
}

impl Devices for Panels {
    fn face(&self, robot: usize) -> Option<Face> {
        self.lock().get(&robot)?.face.clone()
    }

    fn press(&self, robot: usize, key: Key) {
        let mut panels = self.lock();
        let number = Key::ALL.iter().position(|other| *other == key);
        if let (Some(Panel { keys: Some(stream), .. }), Some(number)) = (panels.get_mut(&robot), number) {
            // A program that has ended needs no keys.
            let _ = stream.write_all(&[b'1' + number as u8]);
        }
    }
}
