//! The page's files, as they are in `web/page`.

/// A file: its name, its media type and its content.
type File = (&'static str, &'static str, &'static str);

macro_rules! scripts {
    ($($name:literal),*) => {
        &[$(($name, "text/javascript", include_str!(concat!("../../../web/page/", $name)))),*]
    };
}

const SCRIPTS: &[File] = scripts![
    "desk.js",
    "draw.js",
    "link.js",
    "live.js",
    "main.js",
    "options.js",
    "pointer.js",
    "programs.js",
    "recording.js",
    "relief.js",
    "runner.js",
    "systems.js"
];
const STYLE: File = ("style.css", "text/css", include_str!("../../../web/page/style.css"));
const INDEX: &str = include_str!("../../../web/page/index.html");

/// The media type and the content of a file by its name; the empty name is the page itself.
pub(super) fn file(name: &str) -> Option<(&'static str, String)> {
    if name.is_empty() {
        // By this mark the page knows that it is beside a run.
        return Some((
            "text/html",
            INDEX.replacen("<head>", "<head>\n<meta name=\"beside\" content=\"run\">", 1),
        ));
    }
    let files = SCRIPTS.iter().chain([&STYLE]);
    files.into_iter().find(|file| file.0 == name).map(|&(_, kind, text)| (kind, text.to_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_and_all_that_it_imports_are_there() {
        let (_, page) = file("").unwrap();
        assert!(page.contains("name=\"beside\"") && file("style.css").is_some());
        for (name, _, text) in SCRIPTS {
            for line in text.lines().filter(|line| line.starts_with("import ")) {
                let imported = line.split("\"./").nth(1).and_then(|rest| rest.split('"').next()).unwrap();
                assert!(file(imported).is_some(), "{name} imports {imported}");
            }
        }
        assert_eq!(file("../Cargo.toml"), None);
    }
}
