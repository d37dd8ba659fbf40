//! Folders in which the files of subroutines are searched.

use crate::input;
use crate::text::name;
use husillo_gcode::parameters::{File, Library};
use std::borrow::Cow;
use std::cell::OnceCell;
use std::io::Read;
use std::path::{Path, PathBuf};

/// Largest file of a subroutine, bytes.
const LARGEST: u64 = 16 << 20;

/// Endings of the files of subroutines.
const ENDINGS: [&str; 2] = ["ngc", "nc"];

/// The folders of a program. The file of a subroutine is the first `NAME.ngc` or `NAME.nc` in
/// them, read when it is first called.
#[derive(Debug, Default)]
pub struct Folders {
    folders: Vec<PathBuf>,
    read: Shelf,
}

/// Texts that keep their addresses while others are added.
#[derive(Debug, Default)]
struct Shelf(OnceCell<Box<Book>>);

#[derive(Debug)]
struct Book {
    /// The name in the program.
    name: Vec<u8>,
    /// The path of the file, for messages.
    path: String,
    text: Vec<u8>,
    next: Shelf,
}

impl Folders {
    /// The folder of the program and then `more`. A program from standard input has no folder.
    pub fn of(program: &str, more: &[String]) -> Self {
        let program = name::path(Path::new(program));
        let own = program.parent().filter(|_| *program != *Path::new("-"));
        let folders = own.map(Path::to_path_buf).into_iter();
        let more = more.iter().map(|folder| name::path(Path::new(folder)));
        Self {
            folders: folders.chain(more.map(Cow::into_owned)).collect(),
            read: Shelf::default(),
        }
    }

    fn find(&self, name: &str) -> Option<(String, Vec<u8>)> {
        let paths = self
            .folders
            .iter()
            .flat_map(|folder| ENDINGS.map(|ending| folder.join(format!("{name}.{ending}"))));
        paths.into_iter().find_map(|path| {
            let path = name::text(path.as_os_str());
            let mut text = Vec::new();
            let file = input::open(&path).ok()?;
            let length = file.take(LARGEST + 1).read_to_end(&mut text).ok()?;
            (length as u64 <= LARGEST).then_some((path, text))
        })
    }
}

/// Whether a name is a plain file name: it leads to no other folder.
fn is_plain(name: &str) -> bool {
    let is_part = |byte: u8| byte.is_ascii_alphanumeric() || matches!(byte, b'_' | b'-');
    !name.is_empty() && name.bytes().all(is_part)
}

impl Library for Folders {
    fn file<'t>(&'t self, name: &[u8]) -> Option<File<'t>> {
        let mut slot = &self.read;
        while let Some(book) = slot.0.get() {
            if book.name == name {
                return Some(book.file());
            }
            slot = &book.next;
        }
        let plain = std::str::from_utf8(name)
            .ok()
            .filter(|name| is_plain(name))?;
        let lower = plain.to_ascii_lowercase();
        let found = self.find(plain).or_else(|| self.find(&lower));
        let (path, text) = found?;
        let book = slot.0.get_or_init(|| {
            Box::new(Book {
                name: name.to_owned(),
                path,
                text,
                next: Shelf::default(),
            })
        });
        Some(book.file())
    }
}

impl Book {
    fn file(&self) -> File<'_> {
        File {
            name: self.path.as_bytes(),
            text: &self.text,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_lead_out_of_no_folder() {
        let folder = std::env::temp_dir().join(format!("husillo-library-{}", std::process::id()));
        std::fs::create_dir_all(folder.join("inner")).unwrap();
        std::fs::write(folder.join("outer.ngc"), "o<outer> sub").unwrap();
        std::fs::write(folder.join("inner/bore.nc"), "o<bore> sub").unwrap();
        let inner = folder.join("inner").to_str().unwrap().to_owned();
        let folders = Folders::of("-", std::slice::from_ref(&inner));
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
        let own = Folders::of(&format!("{inner}/part.nc"), &[]);
        assert!(own.file(b"bore").is_some());
        std::fs::remove_dir_all(folder).unwrap();
    }
}
