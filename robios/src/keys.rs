//! Key presses: from a script, automatic, or typed.

use std::collections::VecDeque;
use std::fmt;
use std::str::FromStr;

/// Source of a run's key presses.
///
/// ```text
/// AUTO                          as a patient visitor would; see [`KeyDesk`]
/// NONE                          never
/// TERMINAL                      by whoever sits there; see [`Typed`]
/// KEY1@2s,KEY4@60s              at these times
/// TOUCH:120:80@3,IRTV_OK@5      the display is touched there; a button of the remote control
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub enum KeyPlan {
    /// The first labelled key not yet pressed, when a program waits.
    #[default]
    Auto,
    /// At given times.
    Script(Vec<Press>),
    /// By a user at a terminal.
    Terminal,
}

/// A timed press.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Press {
    /// Time since the start (s).
    pub time: f64,
    /// What is pressed.
    pub what: Button,
}

/// Something to press.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Button {
    /// A soft key, by RoBIOS's number: 1, 2, 4 or 8.
    Key(u32),
    /// The display at a pixel.
    Touch(i32, i32),
    /// A button of the remote control, by RoBIOS's number.
    Remote(i32),
}

/// RoBIOS's numbers of the four soft keys.
pub const KEYS: [u32; 4] = [1, 2, 4, 8];

const REMOTE: [(&str, u8); 10] = [
    ("RED", b'R'),
    ("GREEN", b'G'),
    ("YELLOW", b'Y'),
    ("BLUE", b'B'),
    ("LEFT", b'L'),
    ("RIGHT", b'>'),
    ("UP", b'U'),
    ("DOWN", b'D'),
    ("OK", b'O'),
    ("POWER", b'P'),
];

impl FromStr for KeyPlan {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.trim().to_ascii_uppercase().as_str() {
            "AUTO" => return Ok(Self::Auto),
            "" | "NONE" => return Ok(Self::Script(Vec::new())),
            "TERMINAL" => return Ok(Self::Terminal),
            _ => {}
        }
        let mut presses = text.split(',').map(press).collect::<Result<Vec<_>, _>>()?;
        presses.sort_by(|a, b| a.time.total_cmp(&b.time));
        Ok(Self::Script(presses))
    }
}

fn press(text: &str) -> Result<Press, String> {
    let wrong = || format!("{text:?}; expected AUTO, NONE, TERMINAL, or presses such as KEY1@2s,KEY4@60s");
    let (what, time) = text.trim().split_once('@').ok_or_else(wrong)?;
    let time: f64 = time.trim().trim_end_matches(['s', 'S']).parse().map_err(|_| wrong())?;
    if !(time.is_finite() && time >= 0.0) {
        return Err(wrong());
    }
    let what = button(&what.trim().to_ascii_uppercase()).ok_or_else(wrong)?;
    Ok(Press { time, what })
}

fn button(name: &str) -> Option<Button> {
    if let Some(place) = name.strip_prefix("TOUCH:") {
        let (x, y) = place.split_once(':')?;
        return Some(Button::Touch(x.parse().ok()?, y.parse().ok()?));
    }
    if let Some(button) = name.strip_prefix("IRTV_") {
        let named = REMOTE.iter().find(|(word, _)| *word == button).map(|&(_, code)| code);
        let digit = button.bytes().next().filter(|b| button.len() == 1 && b.is_ascii_digit());
        return named.or(digit).map(|code| Button::Remote(i32::from(code)));
    }
    let number: usize = name.strip_prefix("KEY").unwrap_or(name).parse().ok()?;
    Some(Button::Key(*KEYS.get(number.checked_sub(1)?)?))
}

/// The keys from a program's perspective.
///
/// With [`KeyPlan::Auto`], a program that waits for a key gets, after a second, the first labelled soft key
/// that it accepts, the next one when it waits again under the same labels, and so on cyclically; without
/// labels, the first key that it accepts. Presses are remembered by labels, for menus with submenus. A
/// program that polls for keys gets every labelled key once, each after the robot has stood still for a
/// second. A key whose label ends the program is pressed only after the robot has stood still for ten
/// seconds, and at nine tenths of the time limit. If that does not help, the keys without a label follow.
#[derive(Debug)]
pub struct KeyDesk {
    plan: Plan,
    labels: [String; 4],
    pressed: Pressed,
    /// Presses under other labels.
    others: Vec<([String; 4], Pressed)>,
    /// Start of the program's waiting or polling (s).
    since: Option<f64>,
}

/// Presses under one set of labels.
#[derive(Debug, Clone, Copy, Default)]
struct Pressed {
    /// Number of accepted keys pressed while the program waited.
    waited: usize,
    /// Number of last-resort keys pressed while it polled.
    asked: usize,
    /// The keys pressed.
    keys: u32,
}

#[derive(Debug)]
enum Plan {
    Auto,
    Script(VecDeque<Press>),
    Terminal(Box<dyn Typed>),
}

/// Source of typed soft keys.
pub trait Typed: fmt::Debug + Send {
    /// The next key of [`KEYS`], if any.
    fn next(&mut self) -> Option<u32>;
}

/// A source without keys.
#[derive(Debug)]
struct Nobody;

impl Typed for Nobody {
    fn next(&mut self) -> Option<u32> {
        None
    }
}

/// Interval at which a waiting program checks for typed keys (s).
const GLANCE: f64 = 0.02;
/// Maximum number of sets of labels remembered.
const MOST_LABELS: usize = 100;

/// Result of waiting for a key.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Waiting<T> {
    /// A press.
    Pressed(T),
    /// None yet; check again at this time (s).
    Until(f64),
    /// None will ever come.
    Forever,
}

/// Reaction time before a key press (s).
const REACTION: f64 = 1.0;
/// Time of standing still after which a program seems to be finished (s).
const PATIENCE: f64 = 10.0;
/// Fraction of the time limit after which programs are asked to end.
const LATE: f64 = 0.9;

impl KeyDesk {
    /// Creates the keys of a plan.
    pub fn new(plan: KeyPlan) -> Self {
        Self::with_typed(plan, None)
    }

    /// Creates the keys of a plan, with a source for those of a terminal.
    pub fn with_typed(plan: KeyPlan, typed: Option<Box<dyn Typed>>) -> Self {
        let plan = match plan {
            KeyPlan::Auto => Plan::Auto,
            KeyPlan::Script(presses) => Plan::Script(presses.into()),
            KeyPlan::Terminal => Plan::Terminal(typed.unwrap_or(Box::new(Nobody))),
        };
        Self {
            plan,
            labels: Default::default(),
            pressed: Pressed::default(),
            others: Vec::new(),
            since: None,
        }
    }

    /// Whether a user at a terminal types, which requires real time.
    pub fn is_live(&self) -> bool {
        matches!(self.plan, Plan::Terminal(_))
    }

    /// Whether it matters how long the robot has stood still.
    pub fn watches_robot(&self) -> bool {
        matches!(self.plan, Plan::Auto)
    }

    /// Sets new labels.
    pub fn label(&mut self, labels: [String; 4]) {
        if labels == self.labels {
            return;
        }
        let known = self.others.iter().position(|(others, _)| *others == labels);
        let pressed = known.map_or_else(Pressed::default, |place| self.others.swap_remove(place).1);
        if self.others.len() < MOST_LABELS {
            self.others.push((std::mem::replace(&mut self.labels, labels), self.pressed));
        } else {
            self.labels = labels;
        }
        (self.pressed, self.since) = (pressed, None);
    }

    /// The current labels.
    pub fn labels(&self) -> &[String; 4] {
        &self.labels
    }

    /// The key of [`KEYS`] for a program that polls. `standing` is the time since which the robot stands,
    /// `limit` the time limit (s).
    pub fn read(&mut self, now: f64, standing: f64, limit: f64) -> Option<u32> {
        match &mut self.plan {
            Plan::Script(_) => return self.due(now, key),
            Plan::Terminal(typed) => return typed.next(),
            Plan::Auto => {}
        }
        let since = *self.since.get_or_insert(now);
        let idle = now - since.max(standing);
        let labelled = self.labelled();
        let fresh = labelled.iter().find(|&&(key, ends)| !ends && self.pressed.keys & key == 0);
        if let Some(&(key, _)) = fresh.filter(|_| idle >= REACTION) {
            return Some(self.press_once(key, now));
        }
        if idle < PATIENCE && now < LATE * limit {
            return None;
        }
        // Keys that end the program by their label, other labelled keys, and unlabelled ones, the last of
        // which is the usual one to end programs.
        let of_kind = |kind| labelled.iter().filter(move |&&(_, ends)| ends == kind).map(|&(key, _)| key);
        let rest = [KEYS[3], KEYS[0], KEYS[1], KEYS[2]];
        let rest = rest.into_iter().filter(|key| labelled.iter().all(|(labelled, _)| labelled != key));
        let last: Vec<u32> = of_kind(true).chain(rest).chain(of_kind(false)).collect();
        let key = last[self.pressed.asked % last.len()];
        self.pressed.asked += 1;
        Some(self.press_once(key, now))
    }

    fn press_once(&mut self, key: u32, now: f64) -> u32 {
        self.pressed.keys |= key;
        self.since = Some(now);
        key
    }

    /// Waits for one of the keys in `mask`.
    pub fn wait(&mut self, now: f64, mask: u32) -> Waiting<u32> {
        match &mut self.plan {
            // RoBIOS drops presses of keys other than those waited for.
            Plan::Script(_) => return self.scripted(now, key),
            Plan::Terminal(typed) => {
                return typed.next().map_or(Waiting::Until(now + GLANCE), Waiting::Pressed);
            }
            Plan::Auto => {}
        }
        let since = *self.since.get_or_insert(now);
        if now < since + REACTION {
            return Waiting::Until(since + REACTION);
        }
        self.since = None;
        let labelled = self.labelled().into_iter().map(|(key, _)| key);
        let mut accepted: Vec<u32> = labelled.filter(|key| key & mask != 0).collect();
        if accepted.is_empty() {
            accepted = KEYS.into_iter().filter(|key| key & mask != 0).collect();
        }
        if accepted.is_empty() {
            return Waiting::Forever;
        }
        let key = accepted[self.pressed.waited % accepted.len()];
        self.pressed.waited += 1;
        self.pressed.keys |= key;
        Waiting::Pressed(key)
    }

    /// The touch for a program that polls.
    pub fn read_touch(&mut self, now: f64) -> Option<(i32, i32)> {
        self.due(now, touch)
    }

    /// The touch for a program that waits: the middle of the display, unless scripted.
    pub fn wait_touch(&mut self, now: f64, middle: (i32, i32)) -> Waiting<(i32, i32)> {
        match self.plan {
            Plan::Script(_) => self.scripted(now, touch),
            _ => self.after_a_second(now, middle),
        }
    }

    /// The remote control's button for a program that polls.
    pub fn read_remote(&mut self, now: f64) -> Option<i32> {
        self.due(now, remote)
    }

    /// The remote control's button for a program that waits: `OK`, unless scripted.
    pub fn wait_remote(&mut self, now: f64) -> Waiting<i32> {
        match self.plan {
            Plan::Script(_) => self.scripted(now, remote),
            _ => self.after_a_second(now, i32::from(b'O')),
        }
    }

    fn after_a_second<T>(&mut self, now: f64, value: T) -> Waiting<T> {
        let since = *self.since.get_or_insert(now);
        if now < since + REACTION {
            return Waiting::Until(since + REACTION);
        }
        self.since = None;
        Waiting::Pressed(value)
    }

    /// The labelled keys from left to right, and whether their labels end the program.
    fn labelled(&self) -> Vec<(u32, bool)> {
        let keys = KEYS.iter().zip(&self.labels).filter(|(_, label)| !label.trim().is_empty());
        keys.map(|(&key, label)| (key, ends(label))).collect()
    }

    /// The oldest due press of a kind. Presses of other kinds stay.
    fn due<T>(&mut self, now: f64, kind: impl Fn(Button) -> Option<T>) -> Option<T> {
        let Plan::Script(presses) = &mut self.plan else { return None };
        let place = presses.iter().position(|press| press.time <= now && kind(press.what).is_some())?;
        kind(presses.remove(place)?.what)
    }

    fn scripted<T>(&mut self, now: f64, kind: impl Fn(Button) -> Option<T>) -> Waiting<T> {
        if let Some(value) = self.due(now, &kind) {
            return Waiting::Pressed(value);
        }
        let Plan::Script(presses) = &self.plan else { return Waiting::Forever };
        let next = presses.iter().find(|press| kind(press.what).is_some());
        next.map_or(Waiting::Forever, |press| Waiting::Until(press.time))
    }
}

fn key(button: Button) -> Option<u32> {
    match button {
        Button::Key(key) => Some(key),
        _ => None,
    }
}

fn touch(button: Button) -> Option<(i32, i32)> {
    match button {
        Button::Touch(x, y) => Some((x, y)),
        _ => None,
    }
}

fn remote(button: Button) -> Option<i32> {
    match button {
        Button::Remote(code) => Some(code),
        _ => None,
    }
}

/// Labels of keys that end programs.
const ENDS: [&str; 11] =
    ["END", "EXIT", "QUIT", "STOP", "BYE", "DONE", "FINISH", "FINISHED", "OFF", "CLOSE", "TERMINATE"];

/// Whether a label ends the program.
fn ends(label: &str) -> bool {
    let label = label.trim().to_ascii_uppercase();
    ENDS.contains(&label.as_str())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn desk(plan: &str, labels: [&str; 4]) -> KeyDesk {
        let mut desk = KeyDesk::new(plan.parse().unwrap());
        desk.label(labels.map(str::to_owned));
        desk
    }

    #[test]
    fn plans_are_read_or_refused() {
        let KeyPlan::Script(presses) = "KEY4@60s, key1@2,TOUCH:5:6@3s,IRTV_OK@4,IRTV_7@5".parse().unwrap()
        else {
            panic!("a script");
        };
        let buttons: Vec<Button> = presses.iter().map(|press| press.what).collect();
        let (ok, seven) = (Button::Remote(i32::from(b'O')), Button::Remote(i32::from(b'7')));
        assert_eq!(buttons, [Button::Key(1), Button::Touch(5, 6), ok, seven, Button::Key(8)]);
        assert_eq!("auto".parse(), Ok(KeyPlan::Auto));
        assert_eq!("NONE".parse(), Ok(KeyPlan::Script(vec![])));
        for wrong in
            ["KEY5@2s", "KEY1", "KEY1@", "KEY1@-2", "KEY1@nan", "KEY0@1", "@", "TOUCH:1@2", "IRTV_@1"]
        {
            assert!(wrong.parse::<KeyPlan>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn a_program_that_waits_gets_the_labelled_keys_in_turn() {
        let mut desk = desk("AUTO", ["", "GO", "", "END"]);
        assert_eq!(desk.wait(5.0, u32::MAX), Waiting::Until(6.0));
        assert_eq!(desk.wait(6.0, u32::MAX), Waiting::Pressed(2));
        assert_eq!(desk.wait(7.0, u32::MAX), Waiting::Until(8.0));
        assert_eq!(desk.wait(8.0, u32::MAX), Waiting::Pressed(8));
        desk.wait(9.0, 4);
        assert_eq!(desk.wait(10.0, 4), Waiting::Pressed(4), "the one that it waits for");
        assert_eq!(KeyDesk::new(KeyPlan::Script(vec![])).wait(1.0, 1), Waiting::Forever);
    }

    #[test]
    fn a_program_that_asks_is_not_ended_while_it_drives() {
        let mut desk = desk("AUTO", ["GO", "", "", "END"]);
        assert_eq!(desk.read(0.0, 0.0, 100.0), None);
        assert_eq!(desk.read(1.0, 0.0, 100.0), Some(1));
        let pressed = (2..100).map(f64::from).find(|&now| desk.read(now, now, 100.0).is_some());
        assert_eq!(pressed, Some(90.0), "it drives");
        let mut desk = self::desk("AUTO", ["", "", "", "END"]);
        let pressed = (0..100).map(f64::from).find(|&now| desk.read(now, 3.0, 100.0).is_some());
        assert_eq!(pressed, Some(13.0), "it stands");
    }

    #[test]
    fn a_program_that_has_waited_and_then_asks_is_ended() {
        let mut desk = desk("AUTO", ["GO", "", "", "END"]);
        desk.wait(0.0, 1);
        assert_eq!(desk.wait(1.0, 1), Waiting::Pressed(1));
        let pressed = (2..100).map(f64::from).find_map(|now| desk.read(now, 0.0, 1000.0));
        assert_eq!(pressed, Some(8));
    }

    #[test]
    fn what_was_pressed_in_a_menu_is_remembered() {
        let menu = |desk: &mut KeyDesk, labels: [&str; 4]| desk.label(labels.map(str::to_owned));
        let mut desk = desk("AUTO", ["RUN", "SET", "", "END"]);
        let press = |desk: &mut KeyDesk, now: f64| {
            desk.read(now, 0.0, 1000.0);
            desk.read(now + 1.0, 0.0, 1000.0)
        };
        assert_eq!(press(&mut desk, 10.0), Some(1));
        menu(&mut desk, ["", "", "", "BACK"]);
        assert_eq!(press(&mut desk, 20.0), Some(8));
        menu(&mut desk, ["RUN", "SET", "", "END"]);
        assert_eq!(press(&mut desk, 30.0), Some(2));
    }

    #[test]
    fn typed_keys_are_passed_on() {
        #[derive(Debug)]
        struct Typist(Vec<u32>);
        impl Typed for Typist {
            fn next(&mut self) -> Option<u32> {
                self.0.pop()
            }
        }
        let mut desk = KeyDesk::with_typed("terminal".parse().unwrap(), Some(Box::new(Typist(vec![8, 1]))));
        assert!(desk.is_live());
        assert_eq!(desk.read(0.0, 0.0, 9.0), Some(1));
        assert_eq!(desk.wait(1.0, u32::MAX), Waiting::Pressed(8));
        assert_eq!(desk.wait(2.0, u32::MAX), Waiting::Until(2.0 + GLANCE));
        assert_eq!(desk.read(3.0, 0.0, 9.0), None);
    }

    #[test]
    fn a_script_is_followed() {
        let mut desk = desk("KEY1@2s,KEY4@5s", ["", "", "", ""]);
        assert_eq!(desk.read(1.9, 0.0, 9.0), None);
        assert_eq!(desk.wait(1.9, 1), Waiting::Until(2.0));
        assert_eq!(desk.read(2.0, 0.0, 9.0), Some(1));
        assert_eq!(desk.read(3.0, 0.0, 9.0), None);
        assert_eq!(desk.wait(6.0, 8), Waiting::Pressed(8));
        assert_eq!(desk.wait(6.0, 8), Waiting::Forever);
    }
}
