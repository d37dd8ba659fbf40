//! Tools of a drill file.

/// A tool.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Tool {
    /// The number, as in `T1`.
    pub number: u16,
    /// The diameter in nanometres, above zero. `None` if it is unknown.
    pub diameter_nm: Option<i64>,
    /// Whether the holes are plated. `None` if it is unknown.
    pub plated: Option<bool>,
}

/// The source of the diameter of a tool. Later entries take precedence.
#[derive(Copy, Clone, Eq, PartialEq, PartialOrd, Debug)]
pub(crate) enum Source {
    /// None: the tool is only selected.
    Chosen,
    /// A comment.
    Comment,
    /// The definition of the tool.
    Definition,
    /// The caller.
    Caller,
}

/// Up to `N` tools in the order of their first mention.
///
/// # Cost
/// A look-up takes up to `N` comparisons. The reader looks up each `T`, not each hole.
#[derive(Clone, Debug)]
pub struct Tools<const N: usize> {
    tools: [Option<(Tool, Source)>; N],
}

impl<const N: usize> Tools<N> {
    pub(crate) const EMPTY: Tools<N> = Tools { tools: [None; N] };

    /// Returns the tool with this number.
    pub fn get(&self, number: u16) -> Option<&Tool> {
        self.iter().find(|tool| tool.number == number)
    }

    /// Returns all tools.
    pub fn iter(&self) -> impl Iterator<Item = &Tool> {
        self.tools.iter().flatten().map(|(tool, _)| tool)
    }

    /// Whether the list holds the tool or has room for it.
    pub(crate) fn takes(&self, number: u16) -> bool {
        self.get(number).is_some() || self.tools.iter().any(Option::is_none)
    }

    /// Returns the tool as [`Tools::define`] would store it, and whether it replaces a diameter of
    /// the same source.
    pub(crate) fn preview(&self, tool: Tool, source: Source) -> (Tool, bool) {
        let known = self
            .tools
            .iter()
            .flatten()
            .find(|(known, _)| known.number == tool.number);
        match known {
            Some((known, known_source)) => {
                let wins = source >= *known_source && tool.diameter_nm.is_some();
                let merged = Tool {
                    number: tool.number,
                    diameter_nm: if wins {
                        tool.diameter_nm
                    } else {
                        known.diameter_nm
                    },
                    plated: tool.plated.or(known.plated),
                };
                let replaced = known.diameter_nm != merged.diameter_nm && source == *known_source;
                (merged, replaced)
            }
            None => (tool, false),
        }
    }

    /// Adds a tool, or changes it unless the known source takes precedence. Returns `false` if
    /// there is no room.
    pub(crate) fn define(&mut self, tool: Tool, source: Source) -> bool {
        let (merged, _) = self.preview(tool, source);
        let known = self
            .tools
            .iter_mut()
            .flatten()
            .find(|(known, _)| known.number == tool.number);
        if let Some((known, known_source)) = known {
            *known = merged;
            if source > *known_source && tool.diameter_nm.is_some() {
                *known_source = source;
            }
            return true;
        }
        match self.tools.iter_mut().find(|room| room.is_none()) {
            Some(room) => {
                *room = Some((tool, source));
                true
            }
            None => false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tool(number: u16, nm: i64) -> Tool {
        Tool {
            number,
            diameter_nm: Some(nm),
            plated: None,
        }
    }

    #[test]
    fn the_better_source_wins_in_any_order() {
        let mut tools = Tools::<2>::EMPTY;
        for (nm, source, left, replaced) in [
            (5, Source::Definition, 5, false),
            (6, Source::Comment, 5, false),
            (7, Source::Definition, 7, true),
            (7, Source::Definition, 7, false),
            (8, Source::Caller, 8, false),
            (9, Source::Definition, 8, false),
        ] {
            assert_eq!(
                tools.preview(tool(1, nm), source),
                (tool(1, left), replaced)
            );
            assert!(tools.define(tool(1, nm), source));
            assert_eq!(tools.get(1), Some(&tool(1, left)));
        }
        assert!(tools.define(tool(2, 1), Source::Chosen));
        assert!(!tools.define(tool(3, 1), Source::Caller));
        assert!(tools.takes(2) && !tools.takes(3));
    }
}
