use std::collections::BTreeMap;
use std::ffi::OsString;

use roverlab::geometry::Point;
use roverlab::io::sim::Watcher;
use roverlab::picture::Picture;
use roverlab::world::Scene;
use roverlab_cli::{Onlooker, run_words};
use roverlab_view::overlay_json;
use serde_json::json;

use crate::camera::Camera;
use crate::job::file_of;
use crate::mouth::Mouth;
use crate::{Job, Message, Wish};

/// Runs a job and reports its progress in messages.
pub fn run(job: Job, tell: impl FnMut(Message, &[u8]) + Send + 'static) {
    let Job { words, files, wishes, walls, from } = job;
    let mouth = Mouth::new(tell);
    let page = Page { mouth: mouth.clone(), files, wishes, walls, from };
    let ended = run_words(words.into_iter().map(OsString::from), Some(Box::new(page)));
    mouth.end(json!({ "status": ended.status, "output": ended.output, "errors": ended.errors }));
}

/// The page as observer of a command.
#[derive(Debug)]
struct Page {
    mouth: Mouth,
    files: BTreeMap<String, Vec<u8>>,
    wishes: Vec<Wish>,
    walls: Vec<[Point; 2]>,
    from: f64,
}

impl Onlooker for Page {
    fn told(&mut self, line: &str) {
        self.mouth.tell_line(line, self.from);
    }

    fn file(&mut self, name: &str) -> Option<Vec<u8>> {
        file_of(&self.files, name).cloned()
    }

    fn scene(&mut self, scene: &mut Scene) -> Box<dyn Watcher> {
        Box::new(Camera::of(scene, (&self.walls, self.wishes.clone()), self.from, &self.mouth))
    }

    fn picture(&mut self, picture: &Picture) {
        if let Some(plan) = picture.plan() {
            self.mouth.say(Message::Overlay, overlay_json(plan).to_string().as_bytes());
        }
        self.mouth.say(Message::Picture, picture.to_svg().as_bytes());
    }
}
