//! Programs compiled as their authors meant, whatever the year of their compiler and headers.

use std::path::Path;
use std::process::Command;

use super::{Folder, compiler, report, there_is};

#[test]
fn programs_are_compiled_as_their_authors_meant() {
    if !compiler() {
        return;
    }
    let folder = Folder::new("meant");
    folder.write("helper.h", "int twice(int number);\n");
    folder.write("helper.c", "#include \"helper.h\"\nint twice(int number) { return 2 * number; }\n");
    for (name, text) in [
        // A main function without a return value, functions without prototypes, implicit types.
        (
            "lax.c",
            "#include \"eyebot.h\"\nvoid main() { start(3); LCDPrintf(\"good\"); PSDGet(PSD_FRONT); }\nstart(n) { }\n",
        ),
        // Own names that occur in headers of other years.
        (
            "names.c",
            "#include \"eyebot.h\"\nenum { NONE, WALKER };\nconst int PSD_FRONT = 1;\nint LCDInit(char *text)\n\
             { return LCDPrintf(\"%s\", text); }\nint main() { return LCDInit(\"good\") + NONE; }\n",
        ),
        // Own prototypes, and names of the X window system.
        (
            "prototypes.c",
            "#include \"eyebot.h\"\nvoid LIDARSet(int range, int tilt, int points);\nint RADIOCheck(int *id);\n\
             int main() { int id; LIDARSet(90, 0, 9); if (!RADIOCheck(&id)) LCDPrintf(\"good\"); return 0; }\n",
        ),
        (
            "window.c",
            "#include \"eyebot.h\"\nBool found = True;\nint main() { if (found) LCDPrintf(\"good\"); return 0; }\n",
        ),
        // The same beside sensor names of the header.
        (
            "directions.c",
            "#include \"eyebot.h\"\nenum way { NONE, LEFT, RIGHT };\nint main() { enum way way = NONE;\n\
             LCDPrintf(PSD_FRONT == 1 ? \"good\" : \"bad\"); return way; }\n",
        ),
        // The header of a C library in C++.
        (
            "as_c.cpp",
            "extern \"C\" {\n#include \"eyebot.h\"\n}\nint main() { LCDPrintf(\"good\"); return RADIOCheck(); }\n",
        ),
        // An own source text behind a header.
        (
            "parts.c",
            "#include \"eyebot.h\"\n#include \"helper.h\"\nint main() { if (twice(2) == 4) LCDPrintf(\"good\"); return 0; }\n",
        ),
        // The newest standard.
        (
            "newest.cpp",
            "#include \"eyebot++.h\"\n#include <set>\nint main() { std::set<int> s{1}; if (s.contains(1)) \
             LCDPrintf(\"good\"); return 0; }\n",
        ),
    ] {
        let report = report(&[folder.write(name, text).to_str().unwrap()]);
        assert_eq!((&report["exit"], &report["lcd_text"]), (&0.into(), &"good".into()), "{name}: {report}");
    }
}

#[test]
fn headers_please_every_standard() {
    if !compiler() {
        return;
    }
    let folder = Folder::new("headers");
    let include = Path::new(env!("CARGO_MANIFEST_DIR")).join("include");
    let compile = |compiler: &str, standard: &str, file: &Path| {
        let output = Command::new(compiler)
            .arg(format!("-std={standard}"))
            .args(["-Wall", "-Wextra", "-pedantic", "-Werror", "-fsyntax-only", "-I"])
            .arg(&include)
            .arg(file)
            .output()
            .unwrap();
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.success(), "{compiler} -std={standard}: {message}");
    };
    let text = "#include \"HEADER\"\n#include <X11/Xlib.h>\nint main(void)\n{\n    int id = 0, x, y, z, phi;\n    \
                char text[64];\n    RADIOCheck();\n    RADIOCheck(&id);\n    SERSend(0, text);\n    SERSend(0, text, 3);\n    \
                SERReceive(0, text);\n    SERReceive(0, text, 9);\n    SIMGetObject(1, &x, &y, &z, &phi);\n    \
                SIMGetObject(1, &x, &y, &phi);\n    SIMSetObject(1, 2, 3, 4);\n    SIMSetObject(1, 2, 3, 4, 5);\n    \
                return LCDMenu(\"a\", \"b\", \"c\", \"d\") + CAMWIDTH + XInitThreads();\n}\n";
    let c = folder.write("header.c", &text.replace("HEADER", "eyebot.h"));
    for standard in ["c99", "c11", "c17", "gnu17"] {
        compile("cc", standard, &c);
    }
    let cpp =
        folder.write("header.cpp", &text.replace("HEADER", "eyebot++.h").replace("<X11/Xlib.h>", "<vector>"));
    if there_is("c++") {
        for standard in ["c++11", "c++14", "c++17", "c++20"] {
            compile("c++", standard, &cpp);
        }
    }
}
