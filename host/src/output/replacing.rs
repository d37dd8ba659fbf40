//! Replaces several files at once, as nearly as a file system allows.

use super::{Unfinished, named};
use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};

/// A file that has its final name.
struct Renamed<'a> {
    place: &'a Path,
    /// The old file, under another name. `None`: there was none.
    old: Option<PathBuf>,
}

/// Gives all files their final names by `rename`, in their order. On an error the old files are put
/// back, and the new ones that replaced nothing are removed.
///
/// # Errors
///
/// A file cannot be renamed. The message says so if an old file could not be put back.
pub(super) fn rename_all(
    files: &[Unfinished],
    mut rename: impl FnMut(&Path, &Path) -> io::Result<()>,
) -> io::Result<()> {
    let mut renamed: Vec<Renamed<'_>> = Vec::new();
    for file in files {
        // The last rename has nothing after it that could fail.
        let needs_old = files.last().is_none_or(|last| last.place != file.place);
        let old = match file.old.is_some() && needs_old {
            true => kept(file).map(Some),
            false => Ok(None),
        };
        let done = old.and_then(|old| match rename(&file.beside, &file.place) {
            Ok(()) => Ok(old),
            Err(error) => {
                // The old file still has its own name too.
                let _ = old.map(std::fs::remove_file);
                Err(error)
            }
        });
        match done {
            Ok(old) => renamed.push(Renamed {
                place: &file.place,
                old,
            }),
            Err(error) => return Err(put_back(named(&file.name, &error), renamed, rename)),
        }
    }
    sync_folders(files);
    remove_left_over(files);
    for old in renamed.into_iter().filter_map(|file| file.old) {
        // A second name of an old file that is no longer needed: all outputs are complete.
        let _ = std::fs::remove_file(old);
    }
    Ok(())
}

/// Removes what killed programs have left beside these files: old files between two renames, and
/// new files before them. Each of these files is whole again now, and newer.
fn remove_left_over(files: &[Unfinished]) {
    let mut folders: Vec<&Path> = files
        .iter()
        .filter_map(|file| file.place.parent())
        .collect();
    folders.sort_unstable();
    folders.dedup();
    for folder in folders {
        // A folder that cannot be read keeps them.
        let Ok(entries) = std::fs::read_dir(folder) else {
            continue;
        };
        for entry in entries.flatten() {
            let path = entry.path();
            let is_left = left_over(&path).is_some_and(|(place, process)| {
                files.iter().any(|file| file.place == place) && has_ended(process)
            });
            if is_left {
                let _ = std::fs::remove_file(path);
            }
        }
    }
}

/// The final path and the process of a temporary or an old file, by its name.
fn left_over(path: &Path) -> Option<(PathBuf, u32)> {
    let is_ours = path
        .extension()
        .is_some_and(|end| end == "old" || end == "new");
    let stem = path.with_extension("");
    let (process, number) = stem.extension()?.to_str()?.split_once('-')?;
    number.parse::<u32>().ok()?;
    is_ours.then_some((stem.with_extension(""), process.parse().ok()?))
}

/// Whether there is no process of this number. Where the system does not say it, it may run.
fn has_ended(process: u32) -> bool {
    let processes = Path::new("/proc");
    process != std::process::id()
        && processes.join("self").exists()
        && !processes.join(process.to_string()).exists()
}

/// Gives the old file of an output a second name, or copies it where files have one name only.
fn kept(file: &Unfinished) -> io::Result<PathBuf> {
    let kept = file.beside.with_extension("old");
    std::fs::hard_link(&file.place, &kept)
        .or_else(|_| std::fs::copy(&file.place, &kept).map(|_| ()))?;
    Ok(kept)
}

/// Undoes the renames, the last one first. Returns the error with what could not be undone.
fn put_back(
    error: io::Error,
    renamed: Vec<Renamed<'_>>,
    mut rename: impl FnMut(&Path, &Path) -> io::Result<()>,
) -> io::Error {
    let mut message = error.to_string();
    for file in renamed.into_iter().rev() {
        let undone = match &file.old {
            Some(old) => rename(old, file.place),
            None => std::fs::remove_file(file.place),
        };
        if undone.is_err() {
            let place = file.place.display();
            message += &match &file.old {
                Some(old) => format!("; {place} is new, its old file is {}", old.display()),
                None => format!("; {place} is new"),
            };
        }
    }
    io::Error::new(error.kind(), message)
}

/// Writes the new names to the device.
fn sync_folders(files: &[Unfinished]) {
    let mut folders: Vec<_> = files
        .iter()
        .filter_map(|file| file.place.parent())
        .collect();
    folders.sort_unstable();
    folders.dedup();
    for folder in folders {
        // Some systems cannot open a folder. The names then reach the device a little later.
        let _ = File::open(folder).and_then(|folder| folder.sync_all());
    }
}

#[cfg(test)]
mod tests {
    use super::super::Outputs;
    use super::*;

    const NAMES: [&str; 4] = ["a.cod", "b.cod", "c.toml", "d.html"];

    /// A folder in which all files but the third exist.
    fn folder(name: &str) -> PathBuf {
        let folder = std::env::temp_dir().join(format!("husillo-{}-{name}", std::process::id()));
        let _ = std::fs::remove_dir_all(&folder);
        std::fs::create_dir_all(&folder).unwrap();
        for name in ["a.cod", "b.cod", "d.html"] {
            std::fs::write(folder.join(name), format!("old {name}")).unwrap();
        }
        folder
    }

    fn outputs(folder: &Path) -> Outputs {
        let mut outputs = Outputs::new();
        for name in NAMES {
            let path = folder.join(name);
            let text = format!("new {name}");
            outputs
                .write(path.to_str().unwrap(), text.as_bytes())
                .unwrap();
        }
        outputs
    }

    /// What each file of the list contains.
    fn texts(folder: &Path) -> Vec<Option<String>> {
        let read = |name| std::fs::read_to_string(folder.join(name)).ok();
        NAMES.map(read).into()
    }

    fn old() -> Vec<Option<String>> {
        let old = |name: &str| (name != "c.toml").then(|| format!("old {name}"));
        NAMES.map(old).into()
    }

    fn new() -> Vec<Option<String>> {
        NAMES.map(|name| Some(format!("new {name}"))).into()
    }

    /// Files other than those of the list.
    fn others(folder: &Path) -> Vec<String> {
        let all = std::fs::read_dir(folder).unwrap();
        let names = all.map(|file| file.unwrap().file_name().into_string().unwrap());
        names.filter(|name| !NAMES.contains(&&name[..])).collect()
    }

    #[test]
    fn all_are_replaced_and_nothing_is_left_over() {
        let folder = folder("all");
        outputs(&folder).finish().unwrap();
        assert_eq!(texts(&folder), new());
        assert_eq!(others(&folder), [""; 0]);
        std::fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn a_rename_that_fails_leaves_all_old_files() {
        for (failing, name) in NAMES.iter().enumerate() {
            let folder = folder(&format!("fails-{failing}"));
            let outputs = outputs(&folder);
            let mut number = 0;
            let error = rename_all(&outputs.files, |from, to| {
                number += 1;
                match number == failing + 1 {
                    true => Err(io::ErrorKind::PermissionDenied.into()),
                    false => std::fs::rename(from, to),
                }
            });
            let message = error.unwrap_err().to_string();
            assert!(
                message.contains(name) && !message.contains(';'),
                "{message}"
            );
            drop(outputs);
            assert_eq!(texts(&folder), old(), "rename {failing}");
            assert_eq!(others(&folder), [""; 0], "rename {failing}");
            std::fs::remove_dir_all(folder).unwrap();
        }
    }

    /// The system itself refuses: a folder has taken the place of the third file meanwhile.
    #[test]
    fn a_place_that_became_a_folder_leaves_all_old_files() {
        let folder = folder("place");
        let outputs = outputs(&folder);
        std::fs::create_dir_all(folder.join("c.toml/full")).unwrap();
        let message = outputs.finish().unwrap_err().to_string();
        assert!(message.contains("c.toml"), "{message}");
        assert_eq!(texts(&folder), old());
        assert_eq!(others(&folder), [""; 0]);
        std::fs::remove_dir_all(folder).unwrap();
    }

    /// What cannot be put back is named, with the name under which its old file is kept.
    #[test]
    fn what_cannot_be_put_back_is_named() {
        let folder = folder("undone");
        let outputs = outputs(&folder);
        let mut number = 0;
        let error = rename_all(&outputs.files, |from, to| {
            number += 1;
            match number {
                1 | 2 => std::fs::rename(from, to),
                _ => Err(io::ErrorKind::PermissionDenied.into()),
            }
        });
        let message = error.unwrap_err().to_string();
        for name in ["a.cod", "b.cod"] {
            assert!(message.contains(&format!("{name} is new, its old file is")));
        }
        assert_eq!(others(&folder).len(), 4, "two old files and two new ones");
        drop(outputs);
        assert_eq!(others(&folder).len(), 2, "{:?}", others(&folder));
        std::fs::remove_dir_all(folder).unwrap();
    }

    /// The number of the rename before which the child of the next test dies, and its folder.
    const CHILD: [&str; 2] = ["HUSILLO_DIES_BEFORE", "HUSILLO_FOLDER"];

    /// A killed program leaves each file whole, new ones before old ones, and every old file is
    /// somewhere.
    #[test]
    fn a_kill_between_renames_loses_nothing() {
        if let [Ok(number), Ok(folder)] = CHILD.map(std::env::var) {
            let outputs = outputs(Path::new(&folder));
            let mut left: usize = number.parse().unwrap();
            let _ = rename_all(&outputs.files, |from, to| {
                if left == 0 {
                    std::process::abort();
                }
                left -= 1;
                std::fs::rename(from, to)
            });
            unreachable!("it dies before one of the renames");
        }
        for kill in 0..NAMES.len() {
            let folder = folder(&format!("killed-{kill}"));
            let test = "output::replacing::tests::a_kill_between_renames_loses_nothing";
            let status = std::process::Command::new(std::env::current_exe().unwrap())
                .args(["--exact", test])
                .envs([(CHILD[0], kill.to_string())])
                .env(CHILD[1], &folder)
                .output()
                .unwrap()
                .status;
            assert!(!status.success());
            let expected = [&new()[..kill], &old()[kill..]].concat();
            assert_eq!(texts(&folder), expected, "killed before rename {kill}");
            let kept = others(&folder)
                .into_iter()
                .filter(|name| name.ends_with(".old"));
            let kept: Vec<_> = kept
                .map(|name| std::fs::read_to_string(folder.join(name)).unwrap())
                .collect();
            for text in old().into_iter().flatten() {
                let is_there = texts(&folder).contains(&Some(text.clone()));
                assert!(is_there || kept.contains(&text), "{text}: {kept:?}");
            }
            assert!(!others(&folder).is_empty(), "killed before rename {kill}");
            // Files of others with similar names, or of a program that runs, stay.
            let own = format!("a.cod.{}-7.old", std::process::id());
            let foreign = ["a.cod.old", "b.cod.x-0.old", "e.cod.1-0.old", &own[..]];
            for name in foreign {
                std::fs::write(folder.join(name), "foreign").unwrap();
            }
            // The next run of the same command.
            outputs(&folder).finish().unwrap();
            assert_eq!(texts(&folder), new());
            let mut left = others(&folder);
            left.sort();
            let mut foreign = foreign.map(str::to_owned);
            foreign.sort();
            assert_eq!(left, foreign, "killed before rename {kill}");
            std::fs::remove_dir_all(folder).unwrap();
        }
    }
}
