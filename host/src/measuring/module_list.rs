//! The list of modules of `husillo emulate`.

/// Reads the versions from a list such as `servo:4,servo:4`. The farthest module comes first.
///
/// # Errors
///
/// An unknown module, or too many of them.
pub fn versions(list: &str) -> Result<Vec<u8>, String> {
    let version = |module: &str| match module {
        "servo" | "servo:4" => Some(4),
        "servo:5" => Some(5),
        "servo:10" => Some(10),
        _ => None,
    };
    let versions: Option<Vec<u8>> = list.split(',').map(version).collect();
    let versions = versions.ok_or_else(|| {
        format!("`{list}`: expected servo:4, servo:5 or servo:10, separated by commas")
    })?;
    if versions.len() > usize::from(husillo_transports::nmc::LAST_ADDRESS) {
        return Err(format!("{} modules: a line has at most 32", versions.len()));
    }
    Ok(versions)
}
