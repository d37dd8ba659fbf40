//! A queue in an array.

/// A first-in, first-out queue of at most `N` elements. `N` is a power of two.
#[derive(Copy, Clone, Debug)]
pub(crate) struct Ring<T, const N: usize> {
    slots: [T; N],
    /// Below `N`.
    first: usize,
    /// At most `N`.
    length: usize,
}

impl<T: Copy, const N: usize> Ring<T, N> {
    /// Creates an empty queue. `blank` fills the slots.
    pub(crate) const fn new(blank: T) -> Self {
        const { assert!(N.is_power_of_two(), "slots wrap by a mask") };
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

    /// Whether an element is in the queue.
    pub(crate) fn contains(&self, element: T) -> bool
    where
        T: PartialEq,
    {
        let mut places = (0..self.length).map(|behind| self.place(behind));
        places.any(|place| self.slots.get(place) == Some(&element))
    }

    pub(crate) const fn clear(&mut self) {
        self.length = 0;
    }

    /// Returns the slot of the element `behind` places after the first.
    const fn place(&self, behind: usize) -> usize {
        self.first.wrapping_add(behind) & N.wrapping_sub(1)
    }

    /// Appends an element. A full queue drops it, so the caller checks first.
    pub(crate) fn push(&mut self, element: T) {
        let place = self.place(self.length);
        if let (false, Some(slot)) = (self.is_full(), self.slots.get_mut(place)) {
            *slot = element;
            self.length = self.length.wrapping_add(1);
        }
    }

    /// Returns the element that was pushed last.
    pub(crate) fn last_mut(&mut self) -> Option<&mut T> {
        let behind = self.length.checked_sub(1)?;
        let place = self.place(behind);
        self.slots.get_mut(place)
    }

    /// Returns the oldest element for which `is_wanted` holds.
    pub(crate) fn find_mut(&mut self, is_wanted: impl Fn(&T) -> bool) -> Option<&mut T> {
        let mut places = (0..self.length).map(|behind| self.place(behind));
        let place = places.find(|place| self.slots.get(*place).is_some_and(&is_wanted))?;
        self.slots.get_mut(place)
    }

    pub(crate) fn first(&self) -> Option<T> {
        if self.is_empty() {
            return None;
        }
        self.slots.get(self.first).copied()
    }

    /// Iterates over the elements from the first one on.
    pub(crate) fn iter(&self) -> impl Iterator<Item = T> {
        (0..self.length).filter_map(|behind| self.slots.get(self.place(behind)).copied())
    }

    /// Removes and returns the element that was pushed last.
    pub(crate) fn pop_last(&mut self) -> Option<T> {
        let element = self.last_mut().copied()?;
        self.length = self.length.wrapping_sub(1); // the queue was not empty
        Some(element)
    }

    /// Removes the oldest `elements` elements. The queue holds at least as many.
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
