//! Recognition of the lines of a drawn maze.
//!
//! Files may be damaged: a line is lost, cut short or inserted. The lines of posts vote on the width, and an
//! unexpected line is a defect rather than the end of the drawing.

use std::cmp::Reverse;
use std::collections::BTreeMap;

use crate::maze::Defect;

/// Lines of a drawing: posts and cells alternate, uppermost first.
pub(super) struct Layout<'a> {
    pub(super) lines: Vec<Line<'a>>,
    /// Number of cells from left to right.
    pub(super) width: usize,
    pub(super) post: u8,
    pub(super) defects: Vec<Defect>,
    /// Number of non-blank lines outside the drawing.
    pub(super) remarks: usize,
}

/// A line of a drawing.
#[derive(Clone, Copy)]
pub(super) struct Line<'a> {
    /// Line number in the file, from 1; for a missing line, that of the line in its place.
    pub(super) number: usize,
    /// Text without indentation; `None` if the line is missing.
    pub(super) text: Option<&'a [u8]>,
}

/// Kind of a line.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Posts,
    Cells,
    Other,
}

/// Indentation, width in cells, and post character.
#[derive(Clone, Copy, PartialEq, Eq)]
struct Frame {
    indent: usize,
    width: usize,
    post: u8,
}

/// Whether a character is a post.
pub(super) fn is_post(byte: u8) -> bool {
    b"oO+*".contains(&byte)
}

/// Characters as shown in messages.
pub(super) fn shown(bytes: &[u8]) -> String {
    format!("{:?}", String::from_utf8_lossy(bytes))
}

/// Searches for a drawing.
pub(super) fn find<'a>(lines: &[&'a str]) -> Option<Layout<'a>> {
    let votes: Vec<Frame> = lines.iter().filter_map(|line| vote(line)).collect();
    let indent = most(votes.iter().map(|vote| vote.indent))?;
    let votes = votes.iter().filter(|vote| vote.indent == indent);
    let width = most(votes.clone().map(|vote| vote.width))?;
    let frame = *votes.clone().find(|vote| vote.width == width)?;
    let lines = lines.iter().map(|line| frame.cut(line)).collect();
    let mut finder = Finder { lines, frame, next: 0, found: Vec::new(), defects: Vec::new() };
    finder.next = finder.top();
    let top = finder.next;
    finder.follow();
    finder.note_others(top);
    let said = finder.lines.iter().enumerate().filter(|(_, line)| !is_blank(line));
    let remarks = said.filter(|(index, _)| !(top..finder.next).contains(index)).count();
    Some(Layout { lines: finder.found, width, post: frame.post, defects: finder.defects, remarks })
}

/// Frame of a line of posts: posts four columns apart, with walls between them.
fn vote(line: &str) -> Option<Frame> {
    let indent = line.len() - line.trim_start().len();
    let bytes = line.trim().as_bytes();
    let post = *bytes.first().filter(|&&byte| is_post(byte))?;
    let posts = bytes.iter().step_by(4).take_while(|&&byte| byte == post).count();
    // A post may be missing from a line of the right length.
    let whole = bytes.len() % 4 == 1 && 2 * posts > bytes.len() / 4;
    let width = if whole { bytes.len() / 4 } else { posts - 1 };
    let drawn = bytes.get(1..4).is_some_and(|wall| wall.iter().all(|byte| b"-_= .".contains(byte)));
    (width > 0 && drawn).then_some(Frame { indent, width, post })
}

/// The most frequent value; the first one if several are.
fn most(values: impl Iterator<Item = usize>) -> Option<usize> {
    let mut tallies = BTreeMap::new();
    for (index, value) in values.enumerate() {
        tallies.entry(value).or_insert((0_usize, Reverse(index))).0 += 1;
    }
    tallies.into_iter().max_by_key(|&(_, tally)| tally).map(|(value, _)| value)
}

fn is_blank(line: &[u8]) -> bool {
    line.trim_ascii().is_empty()
}

impl Frame {
    /// A line without indentation.
    fn cut<'a>(&self, line: &&'a str) -> &'a [u8] {
        let blanks = line.bytes().take(self.indent).take_while(u8::is_ascii_whitespace).count();
        &line.as_bytes()[blanks..]
    }

    /// Length of a complete line (characters).
    fn length(&self) -> usize {
        4 * self.width + 1
    }

    fn kind(&self, line: &[u8]) -> Kind {
        let line = &line[..line.len().min(self.length())];
        if self.has_posts(line) {
            Kind::Posts
        } else if self.has_cells(line) {
            Kind::Cells
        } else {
            Kind::Other
        }
    }

    /// Whether most posts of a line are present, and hardly anything else but walls.
    fn has_posts(&self, line: &[u8]) -> bool {
        let posts = line.iter().step_by(4).filter(|&&byte| is_post(byte)).count();
        let odd = |&&byte: &&u8| !is_post(byte) && !b"-_= .|".contains(&byte);
        2 * posts > self.width && line.iter().filter(odd).count() <= (self.width / 4).max(1)
    }

    /// Whether a line has walls beside cells, and hardly anything else in their places.
    fn has_cells(&self, line: &[u8]) -> bool {
        let sides = line.iter().step_by(4);
        let good = sides.clone().filter(|byte| b"|. \t".contains(byte)).count();
        let bars = sides.clone().any(|&byte| byte == b'|');
        let plain = line.len() == self.length() && line.iter().all(|byte| b" .|SGsg\t".contains(byte));
        !is_blank(line) && 4 * good >= 3 * sides.count() && (bars || plain)
    }

    /// Whether a damaged line was meant to be one of posts.
    fn was_posts(line: &[u8]) -> bool {
        !is_blank(line) && line.trim_ascii().iter().all(|&byte| is_post(byte) || b"-_= .|".contains(&byte))
    }

    /// Whether all walls of a line are present.
    fn is_closed(&self, line: &[u8]) -> bool {
        let wall = |x: usize| line.get(4 * x + 1..4 * x + 4).is_some_and(|wall| !wall.contains(&b' '));
        (0..self.width).all(wall)
    }
}

/// Reads a drawing from its first line to its last.
struct Finder<'a> {
    /// The text without the indentation of the drawing.
    lines: Vec<&'a [u8]>,
    frame: Frame,
    /// Index of the next line.
    next: usize,
    found: Vec<Line<'a>>,
    defects: Vec<Defect>,
}

impl Finder<'_> {
    fn kind(&self, index: usize) -> Option<Kind> {
        self.lines.get(index).map(|line| self.frame.kind(line))
    }

    /// First line of the drawing, which may be damaged beyond recognition.
    fn top(&self) -> usize {
        let posts = |line: &&[u8]| {
            vote(&String::from_utf8_lossy(line)).is_some_and(|vote| vote.width == self.frame.width)
        };
        let mut top = self.lines.iter().position(posts).unwrap_or(0);
        loop {
            let above = |lines: usize| top.checked_sub(lines).and_then(|index| self.kind(index));
            match (above(1), above(2)) {
                (Some(Kind::Cells), Some(Kind::Posts)) => top -= 2,
                (Some(Kind::Cells), Some(Kind::Other)) if Frame::was_posts(self.lines[top - 2]) => {
                    return top - 2;
                }
                (Some(Kind::Cells), _) => return top - 1,
                (Some(Kind::Posts), _) => top -= 1,
                _ => return top,
            }
        }
    }

    /// Takes lines of posts and cells alternately until neither follows.
    fn follow(&mut self) {
        loop {
            let wanted = if self.found.len().is_multiple_of(2) { Kind::Posts } else { Kind::Cells };
            let here = self.kind(self.next);
            let then = self.kind(self.next + 1);
            if here == Some(wanted) {
                self.take();
            } else if then == Some(wanted) && self.is_top_again() {
                self.skip(wanted);
            } else if wanted == Kind::Cells && self.another_begins() {
                return;
            } else if here.is_some_and(|kind| kind != Kind::Other) {
                self.miss(wanted);
            } else if here.is_some() && then == Some(wanted) {
                self.skip(wanted);
            } else if here.is_some() && (then.is_some_and(|kind| kind != Kind::Other) || self.is_end(wanted))
            {
                self.repair(wanted);
            } else {
                if wanted == Kind::Posts {
                    self.miss(wanted);
                }
                return;
            }
        }
    }

    /// Whether the next line repeats the top one.
    fn is_top_again(&self) -> bool {
        self.found.len() == 1 && self.found[0].text == Some(self.lines[self.next])
    }

    /// Whether another drawing begins below this one: both are closed there.
    fn another_begins(&self) -> bool {
        let closed = |line: &[u8]| self.frame.is_closed(line);
        let last = self.found.last().and_then(|line| line.text).is_some_and(closed);
        let row = |line: &&[u8]| is_blank(line) && line.len() >= self.frame.length();
        let below = match self.kind(self.next) {
            Some(Kind::Other) if !row(&self.lines[self.next]) => self.next + 1,
            _ => self.next,
        };
        last && self.kind(below) == Some(Kind::Posts) && closed(self.lines[below])
    }

    /// Whether the next line is the remainder of the lowest one.
    fn is_end(&self, wanted: Kind) -> bool {
        wanted == Kind::Posts && Frame::was_posts(self.lines[self.next])
    }

    fn take(&mut self) {
        self.found.push(Line { number: self.next + 1, text: Some(self.lines[self.next]) });
        self.next += 1;
    }

    /// Records a defect: the next line, and what was expected.
    fn note(&mut self, wanted: Kind, made: &str) {
        let found = match self.lines.get(self.next) {
            None => "the end of the file".into(),
            Some(line) if is_blank(line) => "a blank line".into(),
            Some(line) => shown(&line[..line.len().min(40)]),
        };
        let expected = if wanted == Kind::Posts { "posts" } else { "cells" };
        let message = format!("found {found}; expected a line of {expected}; {made}");
        self.defects.push(Defect::at(self.next + 1, message));
    }

    /// Inserts a missing line.
    fn miss(&mut self, wanted: Kind) {
        self.note(wanted, "its walls are unknown");
        self.found.push(Line { number: self.next + 1, text: None });
    }

    /// Skips an inserted line.
    fn skip(&mut self, wanted: Kind) {
        self.note(wanted, "skipped");
        self.next += 1;
    }

    /// Takes a damaged line for the expected one.
    fn repair(&mut self, wanted: Kind) {
        let line = self.lines[self.next];
        if !is_blank(line) {
            self.note(wanted, "read as one");
            self.take();
        } else if wanted == Kind::Cells && line.len() >= self.frame.length() {
            self.take();
        } else {
            self.miss(wanted);
            self.next += 1;
        }
    }

    /// Reports the first line outside the drawing that looks like part of a drawing.
    fn note_others(&mut self, top: usize) {
        let drawn = |line: &[u8]| vote(&String::from_utf8_lossy(line)).is_some();
        let above = self.lines[..top].iter().position(|line| drawn(line));
        let below = || (self.next..self.lines.len()).find(|&index| self.kind(index) != Some(Kind::Other));
        if let Some(index) = above.or_else(below) {
            let message = format!(
                "found {} outside of the picture; expected remarks; ignored",
                shown(self.lines[index])
            );
            self.defects.push(Defect::at(index + 1, message));
        }
    }
}
