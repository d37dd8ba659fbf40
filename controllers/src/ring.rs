//! A queue in an array.

/// First in, first out; at most `N`, a power of two.
#[derive(Copy, Clone, Debug)]
pub(crate) struct Ring<T, const N: usize> {
    slots: [T; N],
    /// Below `N`.
    first: usize,
    /// At most `N`.
    length: usize,
}

impl<T: Copy, const N: usize> Ring<T, N> {
    /// Empty; `blank` fills the places.
    pub(crate) const fn new(blank: T) -> Self {
        const { assert!(N.is_power_of_two(), "places wrap by a mask") };
        Ring {
            slots: [blank; N],
            first: 0,
            length: 0,
        }
    }

    pub(crate) const fn len(&self) -> usize {
        self.length
    }

    pub(crate) const fn is_empty(&self) -> bool {
        self.length == 0
    }

    pub(crate) const fn is_full(&self) -> bool {
        self.length >= N
    }

    pub(crate) const fn clear(&mut self) {
        self.length = 0;
    }

    /// The place of the element so many behind the first one.
    const fn place(&self, behind: usize) -> usize {
        self.first.wrapping_add(behind) & N.wrapping_sub(1)
    }

    /// Appends; dropped when it is full: ask before.
    pub(crate) fn push(&mut self, element: T) {
        let place = self.place(self.length);
        if let (false, Some(slot)) = (self.is_full(), self.slots.get_mut(place)) {
            *slot = element;
            self.length = self.length.wrapping_add(1);
        }
    }

    /// The one that was pushed last.
    pub(crate) fn last_mut(&mut self) -> Option<&mut T> {
        let behind = self.length.checked_sub(1)?;
        let place = self.place(behind);
        self.slots.get_mut(place)
    }

    pub(crate) fn first(&self) -> Option<T> {
        if self.is_empty() {
            return None;
        }
        self.slots.get(self.first).copied()
    }

    /// From the first one on.
    pub(crate) fn iter(&self) -> impl Iterator<Item = T> {
        (0..self.length).filter_map(|behind| self.slots.get(self.place(behind)).copied())
    }

    /// Takes back the one that was pushed last.
    pub(crate) fn pop_last(&mut self) -> Option<T> {
        let element = self.last_mut().copied()?;
        self.length = self.length.wrapping_sub(1); // it was not 0
        Some(element)
    }

    /// Without so many of the oldest; it holds more.
    pub(crate) const fn drop_first(&mut self, elements: usize) {
        self.first = self.place(elements);
        self.length = self.length.wrapping_sub(elements);
    }

    pub(crate) fn pop(&mut self) -> Option<T> {
        let element = self.first()?;
        self.drop_first(1);
        Some(element)
    }
}
