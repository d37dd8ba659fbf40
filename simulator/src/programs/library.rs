//! Files of subroutines, read when they are first called.

use husillo_gcode::parameters::{File, Library};
use std::cell::OnceCell;
use std::fmt::Debug;

/// Where the files of subroutines are: folders, or a list of texts.
pub trait Files: Debug {
    /// The name for messages and the text of the file of subroutine `name`, a plain file name
    /// without an ending. `None`: there is no such file.
    fn find(&self, name: &str) -> Option<(String, Vec<u8>)>;
}

/// The subroutines of a program that are in files of their own. Each file is read once. The
/// default has none.
#[derive(Debug, Default)]
pub struct Subroutines {
    files: Option<Box<dyn Files>>,
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

impl Subroutines {
    /// Subroutines in these files.
    pub fn new(files: impl Files + 'static) -> Self {
        Self {
            files: Some(Box::new(files)),
            read: Shelf::default(),
        }
    }

    fn find(&self, name: &str) -> Option<(String, Vec<u8>)> {
        self.files.as_ref()?.find(name)
    }
}

/// Whether a name is a plain file name: it leads to no other folder.
fn is_plain(name: &str) -> bool {
    let is_part = |byte: u8| byte.is_ascii_alphanumeric() || matches!(byte, b'_' | b'-');
    !name.is_empty() && name.bytes().all(is_part)
}

impl Library for Subroutines {
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
