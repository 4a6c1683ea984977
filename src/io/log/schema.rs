//! Schemas of the messages in a recording: Protocol Buffers descriptors for viewers.

use super::wire::Fields;

/// Content of a channel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Schema {
    Call,
    LaserScan,
    PoseInFrame,
    FrameTransform,
    RawImage,
    SceneUpdate,
}

impl Schema {
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Call => "roverlab.Call",
            Self::LaserScan => "foxglove.LaserScan",
            Self::PoseInFrame => "foxglove.PoseInFrame",
            Self::FrameTransform => "foxglove.FrameTransform",
            Self::RawImage => "foxglove.RawImage",
            Self::SceneUpdate => "foxglove.SceneUpdate",
        }
    }

    /// A `google.protobuf.FileDescriptorSet` with the message and all its parts.
    pub(super) fn descriptor(self) -> Vec<u8> {
        let mut set = Vec::new();
        let mut needed = vec![self.name()];
        let mut next = 0;
        while let Some(&name) = needed.get(next) {
            next += 1;
            for (_, kind) in Message::named(name).fields() {
                let kind = kind.trim_start_matches('*');
                if kind.contains('.') && !needed.contains(&kind) {
                    needed.push(kind);
                }
            }
        }
        needed.sort_unstable_by_key(|name| (package(name) != GOOGLE, *name));
        let mut packages: Vec<&str> = needed.iter().map(|name| package(name)).collect();
        packages.dedup();
        for &name in &packages {
            let messages: Vec<&str> =
                needed.iter().copied().filter(|message| package(message) == name).collect();
            let imports = if name == GOOGLE { &[] } else { &packages[..usize::from(packages[0] == GOOGLE)] };
            Fields(&mut set).message(1, |file| write_file(file, name, imports, &messages));
        }
        set
    }
}

/// The package of Protobuf's own messages.
const GOOGLE: &str = "google.protobuf";

/// A message's name, and one line per field: name, number and type, with a star for a repeated one.
/// Enumerations list their values, from 0.
struct Message(&'static str, &'static str);

/// Messages used in recordings, from Foxglove's published schemas.
const MESSAGES: &[Message] = &[
    Message("google.protobuf.Timestamp", "seconds 1 int64\nnanos 2 int32"),
    Message("google.protobuf.Duration", "seconds 1 int64\nnanos 2 int32"),
    Message(
        "roverlab.Call",
        "method 1 string\narguments 2 roverlab.Values\nresult 3 roverlab.Values\nerror 4 roverlab.Error",
    ),
    Message("roverlab.Values", "numbers 1 *double\nintegers 2 *sint64\ntexts 3 *string\ndata 4 bytes"),
    Message("roverlab.Error", "kind 1 string\nmessage 2 string\ncauses 3 *string"),
    Message("foxglove.Vector3", "x 1 double\ny 2 double\nz 3 double"),
    Message("foxglove.Point3", "x 1 double\ny 2 double\nz 3 double"),
    Message("foxglove.Quaternion", "x 1 double\ny 2 double\nz 3 double\nw 4 double"),
    Message("foxglove.Pose", "position 1 foxglove.Vector3\norientation 2 foxglove.Quaternion"),
    Message("foxglove.Color", "r 1 double\ng 2 double\nb 3 double\na 4 double"),
    Message("foxglove.KeyValuePair", "key 1 string\nvalue 2 string"),
    Message(
        "foxglove.LaserScan",
        "timestamp 1 google.protobuf.Timestamp\nframe_id 2 string\npose 3 foxglove.Pose\nstart_angle 4 double\n\
         end_angle 5 double\nranges 6 *double\nintensities 7 *double",
    ),
    Message(
        "foxglove.PoseInFrame",
        "timestamp 1 google.protobuf.Timestamp\nframe_id 2 string\npose 3 foxglove.Pose",
    ),
    Message(
        "foxglove.FrameTransform",
        "timestamp 1 google.protobuf.Timestamp\nparent_frame_id 2 string\nchild_frame_id 3 string\n\
         translation 4 foxglove.Vector3\nrotation 5 foxglove.Quaternion",
    ),
    Message(
        "foxglove.RawImage",
        "timestamp 1 google.protobuf.Timestamp\nframe_id 7 string\nwidth 2 fixed32\nheight 3 fixed32\n\
         encoding 4 string\nstep 5 fixed32\ndata 6 bytes",
    ),
    Message(
        "foxglove.CompressedImage",
        "timestamp 1 google.protobuf.Timestamp\nframe_id 4 string\ndata 2 bytes\nformat 3 string",
    ),
    Message(
        "foxglove.SceneUpdate",
        "deletions 1 *foxglove.SceneEntityDeletion\nentities 2 *foxglove.SceneEntity",
    ),
    Message(
        "foxglove.SceneEntityDeletion",
        "timestamp 1 google.protobuf.Timestamp\ntype 2 Type=MATCHING_ID,ALL\nid 3 string",
    ),
    Message(
        "foxglove.SceneEntity",
        "timestamp 1 google.protobuf.Timestamp\nframe_id 2 string\nid 3 string\n\
         lifetime 4 google.protobuf.Duration\nframe_locked 5 bool\nmetadata 6 *foxglove.KeyValuePair\n\
         arrows 7 *foxglove.ArrowPrimitive\ncubes 8 *foxglove.CubePrimitive\n\
         spheres 9 *foxglove.SpherePrimitive\ncylinders 10 *foxglove.CylinderPrimitive\n\
         lines 11 *foxglove.LinePrimitive\ntriangles 12 *foxglove.TriangleListPrimitive\n\
         texts 13 *foxglove.TextPrimitive\nmodels 14 *foxglove.ModelPrimitive",
    ),
    Message(
        "foxglove.ArrowPrimitive",
        "pose 1 foxglove.Pose\nshaft_length 2 double\nshaft_diameter 3 double\nhead_length 4 double\n\
         head_diameter 5 double\ncolor 6 foxglove.Color",
    ),
    Message(
        "foxglove.CubePrimitive",
        "pose 1 foxglove.Pose\nsize 2 foxglove.Vector3\ncolor 3 foxglove.Color",
    ),
    Message(
        "foxglove.SpherePrimitive",
        "pose 1 foxglove.Pose\nsize 2 foxglove.Vector3\ncolor 3 foxglove.Color",
    ),
    Message(
        "foxglove.CylinderPrimitive",
        "pose 1 foxglove.Pose\nsize 2 foxglove.Vector3\nbottom_scale 3 double\ntop_scale 4 double\n\
         color 5 foxglove.Color",
    ),
    Message(
        "foxglove.LinePrimitive",
        "type 1 Type=LINE_STRIP,LINE_LOOP,LINE_LIST\npose 2 foxglove.Pose\nthickness 3 double\n\
         scale_invariant 4 bool\npoints 5 *foxglove.Point3\ncolor 6 foxglove.Color\ncolors 7 *foxglove.Color\n\
         indices 8 *fixed32",
    ),
    Message(
        "foxglove.TriangleListPrimitive",
        "pose 1 foxglove.Pose\npoints 2 *foxglove.Point3\ncolor 3 foxglove.Color\ncolors 4 *foxglove.Color\n\
         indices 5 *fixed32",
    ),
    Message(
        "foxglove.TextPrimitive",
        "pose 1 foxglove.Pose\nbillboard 2 bool\nfont_size 3 double\nscale_invariant 4 bool\n\
         color 5 foxglove.Color\ntext 6 string",
    ),
    Message(
        "foxglove.ModelPrimitive",
        "pose 1 foxglove.Pose\nscale 2 foxglove.Vector3\ncolor 3 foxglove.Color\noverride_color 4 bool\n\
         url 5 string\nmedia_type 6 string\ndata 7 bytes",
    ),
];

impl Message {
    /// The message with a name. All names in this file are in the table, as a test verifies.
    fn named(name: &str) -> &'static Self {
        MESSAGES.iter().find(|message| message.0 == name).unwrap_or(&MESSAGES[0])
    }

    /// Names and numbers of the fields, and their types.
    fn fields(&self) -> impl Iterator<Item = ((&'static str, u64), &'static str)> {
        self.1.lines().filter_map(|line| {
            let mut words = line.split(' ');
            Some(((words.next()?, words.next()?.parse().ok()?), words.next()?))
        })
    }
}

/// The part before the last dot.
fn package(name: &str) -> &str {
    name.rsplit_once('.').map_or("", |(package, _)| package)
}

fn own_name(name: &str) -> &str {
    name.rsplit_once('.').map_or(name, |(_, own)| own)
}

/// A `FileDescriptorProto`.
fn write_file(file: &mut Fields<'_>, package: &str, imports: &[&str], messages: &[&str]) {
    let path = |package: &str| format!("{}.proto", package.replace('.', "/"));
    file.text(1, &path(package));
    file.text(2, package);
    for import in imports {
        file.text(3, &path(import));
    }
    for &name in messages {
        file.message(4, |message| write_message(message, Message::named(name)));
    }
    file.text(12, "proto3");
}

/// A `DescriptorProto`.
fn write_message(out: &mut Fields<'_>, message: &Message) {
    out.text(1, own_name(message.0));
    for ((name, number), kind) in message.fields() {
        out.message(2, |field| write_field(field, message.0, name, number, kind));
    }
    for (_, kind) in message.fields() {
        if let Some((name, alternatives)) = kind.split_once('=') {
            out.message(4, |enumeration| {
                enumeration.text(1, name);
                for (number, name) in alternatives.split(',').enumerate() {
                    enumeration.message(2, |alternative| {
                        alternative.text(1, name);
                        alternative.integer(2, number as u64);
                    });
                }
            });
        }
    }
}

/// A `FieldDescriptorProto`.
fn write_field(field: &mut Fields<'_>, message: &str, name: &str, number: u64, kind: &str) {
    /// Protobuf's type number of message fields.
    const MESSAGE: u64 = 11;
    /// Protobuf's type number of enumeration fields.
    const ENUMERATION: u64 = 14;
    let (label, kind) = kind.strip_prefix('*').map_or((1, kind), |kind| (3, kind));
    let (number_of_kind, type_name) = match kind {
        "double" => (1, None),
        "int64" => (3, None),
        "int32" => (5, None),
        "fixed32" => (7, None),
        "bool" => (8, None),
        "string" => (9, None),
        "bytes" => (12, None),
        "sint64" => (18, None),
        kind => match kind.split_once('=') {
            Some((name, _)) => (ENUMERATION, Some(format!(".{message}.{name}"))),
            None => (MESSAGE, Some(format!(".{kind}"))),
        },
    };
    field.text(1, name);
    field.integer(3, number);
    field.integer(4, label);
    field.integer(5, number_of_kind);
    if let Some(type_name) = type_name {
        field.text(6, &type_name);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_type_is_in_the_table() {
        for message in MESSAGES {
            let lines = message.1.lines().count();
            assert_eq!(message.fields().count(), lines, "{}", message.0);
            for (_, kind) in message.fields() {
                let kind = kind.trim_start_matches('*');
                assert!(!kind.contains('.') || Message::named(kind).0 == kind, "{kind}");
            }
        }
    }

    #[test]
    fn a_schema_brings_what_it_consists_of_and_no_more() {
        let scan = Schema::LaserScan.descriptor();
        let holds = |name: &[u8]| scan.windows(name.len()).any(|part| part == name);
        assert!(holds(b"google/protobuf.proto") && holds(b"Quaternion") && !holds(b"SceneEntity"));
        assert!(Schema::Call.descriptor().starts_with(&[0x0a]));
    }
}
