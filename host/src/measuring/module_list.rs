//! A list of modules, as `emulate` takes it.

/// Versions of a list such as `servo:4,servo:4`, from the far end.
///
/// # Errors
///
/// A sentence about the list.
pub fn versions(list: &str) -> Result<Vec<u8>, String> {
    let version = |module: &str| match module {
        "servo" | "servo:4" => Some(4),
        "servo:5" => Some(5),
        "servo:10" => Some(10),
        _ => None,
    };
    let versions: Option<Vec<u8>> = list.split(',').map(version).collect();
    let versions = versions.ok_or_else(|| {
        format!("`{list}`: expected servo:4, servo:5 or servo:10, with commas between")
    })?;
    if versions.len() > usize::from(husillo_transports::nmc::LAST_ADDRESS) {
        return Err(format!("{} modules: a line has 32 at most", versions.len()));
    }
    Ok(versions)
}
