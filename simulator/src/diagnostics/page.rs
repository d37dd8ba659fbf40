//! The page of findings, with the remedy of each.

/// The page.
pub const FINDINGS: &str = include_str!("../../docs/findings.md");

/// What to do about a finding: the last cell of its row.
pub fn remedy(code: &str) -> Option<&'static str> {
    let row = FINDINGS.lines().find(|line| {
        let cell = line
            .strip_prefix("| ")
            .and_then(|row| row.split(' ').next());
        cell == Some(code)
    })?;
    let cell = row.strip_suffix('|')?.rsplit('|').next()?.trim();
    (!cell.is_empty()).then_some(cell)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_finding_has_a_remedy() {
        let codes = FINDINGS.lines().filter_map(|line| {
            let code = line.strip_prefix("| ")?.split(' ').next()?;
            let number = code.strip_prefix(['E', 'W'])?;
            number.parse::<u16>().is_ok().then_some(code)
        });
        let mut count = 0;
        for code in codes {
            assert!(remedy(code).is_some(), "{code}");
            count += 1;
        }
        assert!(count > 70, "{count}");
        assert_eq!(remedy("E0203"), Some("write two lines"));
        assert_eq!(remedy("E9999"), None);
    }
}
