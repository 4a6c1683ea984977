//! The recording of a run: written for `--record`, and replayed for `--replay`.

use roverlab::io::log::{Attachment, Header, LogError, LogFile, LogWriter, Player};
use roverlab::world::{Scene, formats};

use super::super::{CommonArgs, Failure, Origin, unrecordable};
use super::{Driven, RECORDS, StageTruth};

/// The recording being written, and the one being replayed.
#[derive(Debug, Default)]
pub(super) struct Recording {
    pub(super) writer: Option<LogWriter<LogFile>>,
    pub(super) player: Option<Player>,
    pub(super) origin: Origin,
}

impl CommonArgs {
    /// Starts the recording of `--record`.
    pub(super) fn recording(&self, scene: &Scene, player: Option<Player>) -> Result<Recording, Failure> {
        let mut recording = Recording { writer: None, player, origin: self.origin.clone() };
        self.origin.set_staged();
        let Some(file) = self.record.as_ref().filter(|_| RECORDS) else { return Ok(recording) };
        let facts = self.origin.facts();
        let header = facts.log.as_ref().map_or_else(
            || Header {
                seed: Some(self.seed),
                attachments: texts(scene).into_iter().chain(self.origin.files()).collect(),
                ..Header::new(&facts.program, &facts.options)
            },
            |log| log.header().clone(),
        );
        let open = || if self.force { LogFile::replace(file) } else { LogFile::create(file) };
        let open = || if self.fsync { open().map(LogFile::synced) } else { open() };
        let writer = open()
            .and_then(|sink| LogWriter::new(sink, &header))
            .map_err(|error| unrecordable(format_args!("--record {}", file.display()), &error))?;
        writer.show(scene);
        recording.writer = Some(writer);
        Ok(recording)
    }
}

/// World and robots as text.
fn texts(scene: &Scene) -> Vec<Attachment> {
    let text = |name: String, text: String| Attachment {
        name,
        media_type: "text/plain".into(),
        data: text.into_bytes(),
    };
    let mut files = vec![text("scene.wld".into(), formats::wld::print(&scene.world))];
    let mut script = formats::sim::SimFile::for_scene(scene, "scene.wld");
    for (index, robot) in scene.robots.iter().enumerate() {
        if !scene.robots[..index].iter().any(|other| other.spec == robot.spec) {
            let name = format!("scene.robot{}.robi", index + 1);
            script.statements.insert(1, formats::sim::Statement::Robot(name.clone()));
            files.push(text(name, formats::robi::print(&robot.spec)));
        }
    }
    files.push(text("scene.sim".into(), formats::sim::print(&script)));
    files
}

/// A robot of a recording.
pub(super) fn replayed_robot(player: &Player, index: usize) -> Result<Driven, Failure> {
    if RECORDS {
        Ok(Box::new(player.robot(index).map_err(|error| foreign(&error))?))
    } else {
        Err(no_recordings())
    }
}

/// Ground truth of a robot of a recording.
pub(super) fn replayed_truth(player: &Player, index: usize) -> Result<StageTruth, Failure> {
    if RECORDS {
        Ok(Box::new(player.truth(index).map_err(|error| foreign(&error))?))
    } else {
        Err(no_recordings())
    }
}

fn no_recordings() -> Failure {
    Failure::input("--replay: found a recording; expected a program that replays")
}

/// The error for a recording without the robot, which belongs to another scene.
fn foreign(error: &LogError) -> Failure {
    Failure::input(format!("--replay: {error}"))
}

impl Recording {
    /// Wraps a robot in a recorder, if there is a recording.
    pub(super) fn recorder(&self, robot: Driven, index: usize) -> Driven {
        match &self.writer {
            Some(writer) if RECORDS => Box::new(writer.recorder(robot, index)),
            _ => robot,
        }
    }
}

impl Drop for Recording {
    fn drop(&mut self) {
        let finished = self.writer.take().map(|writer| writer.finish().and_then(LogFile::complete));
        if let Some(Err(error)) = finished {
            self.origin.note(format!("--record: the recording is incomplete: {error}"));
        }
        if let Some((time, call)) = self.player.as_ref().and_then(Player::rest) {
            self.origin.note(format!(
                "--replay: the run has ended; expected the call {call} at {time} s, as recorded"
            ));
        }
    }
}
