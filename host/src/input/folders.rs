//! Folders in which the files of subroutines are searched.

use super::open;
use husillo_simulator::programs::library::{Files, Subroutines};
use husillo_simulator::text::name;
use std::borrow::Cow;
use std::io::Read;
use std::path::{Path, PathBuf};

/// Largest file of a subroutine, bytes.
const LARGEST: u64 = 16 << 20;

/// Endings of the files of subroutines.
const ENDINGS: [&str; 2] = ["ngc", "nc"];

/// The folders of a program. The file of a subroutine is the first `NAME.ngc` or `NAME.nc` in
/// them.
#[derive(Debug)]
struct Folders(Vec<PathBuf>);

/// The subroutines in the folder of the program, and then in those of `more`. A program from
/// standard input has no folder.
pub fn folders(program: &str, more: &[String]) -> Subroutines {
    let program = name::path(Path::new(program));
    let own = program.parent().filter(|_| *program != *Path::new("-"));
    let folders = own.map(Path::to_path_buf).into_iter();
    let more = more.iter().map(|folder| name::path(Path::new(folder)));
    Subroutines::new(Folders(folders.chain(more.map(Cow::into_owned)).collect()))
}

impl Files for Folders {
    fn find(&self, name: &str) -> Option<(String, Vec<u8>)> {
        let paths = self
            .0
            .iter()
            .flat_map(|folder| ENDINGS.map(|ending| folder.join(format!("{name}.{ending}"))));
        paths.into_iter().find_map(|path| {
            let path = name::text(path.as_os_str());
            let mut text = Vec::new();
            let file = open(&path).ok()?;
            let length = file.take(LARGEST + 1).read_to_end(&mut text).ok()?;
            (length as u64 <= LARGEST).then_some((path, text))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use husillo_gcode::parameters::Library;

    #[test]
    fn names_lead_out_of_no_folder() {
        let folder = std::env::temp_dir().join(format!("husillo-library-{}", std::process::id()));
        std::fs::create_dir_all(folder.join("inner")).unwrap();
        std::fs::write(folder.join("outer.ngc"), "o<outer> sub").unwrap();
        std::fs::write(folder.join("inner/bore.nc"), "o<bore> sub").unwrap();
        let inner = folder.join("inner").to_str().unwrap().to_owned();
        let folders = folders("-", std::slice::from_ref(&inner));
        let file = folders.file(b"bore").expect("a file");
        assert_eq!(file.text, b"o<bore> sub");
        assert_eq!(file.name, format!("{inner}/bore.nc").as_bytes());
        assert!(folders.file(b"BORE").is_some());
        for name in [
            &b"../outer"[..],
            b"outer",
            b"",
            b".",
            b"..",
            b"/etc/passwd",
            b"inner/../../outer",
            b"bore.nc",
            b"b\xffre",
        ] {
            assert!(folders.file(name).is_none(), "{name:?}");
        }
        let own = super::folders(&format!("{inner}/part.nc"), &[]);
        assert!(own.file(b"bore").is_some());
        std::fs::remove_dir_all(folder).unwrap();
    }
}
