//! A ring buffer in an array.

/// A queue of at most `CAPACITY` elements: first in, first out; the newest element can also be
/// removed.
#[derive(Clone, Debug)]
pub(crate) struct Ring<T, const CAPACITY: usize> {
    slots: [Option<T>; CAPACITY],
    head: usize,
    len: usize,
}

impl<T, const CAPACITY: usize> Ring<T, CAPACITY> {
    pub(crate) const fn new() -> Self {
        Self {
            slots: [const { None }; CAPACITY],
            head: 0,
            len: 0,
        }
    }

    pub(crate) const fn len(&self) -> usize {
        self.len
    }

    pub(crate) const fn is_full(&self) -> bool {
        self.len >= CAPACITY
    }

    /// Index of the slot `offset` elements behind the oldest one; `offset` is below `CAPACITY`.
    fn place(&self, offset: usize) -> usize {
        // head and offset are below CAPACITY, and an array has fewer than 2^63 elements.
        let place = self.head.wrapping_add(offset);
        if place >= CAPACITY {
            place.wrapping_sub(CAPACITY)
        } else {
            place
        }
    }

    /// Appends the element. A full queue drops it, so check [`Ring::is_full`] first.
    pub(crate) fn push_back(&mut self, element: T) {
        if self.is_full() {
            return;
        }
        let place = self.place(self.len);
        if let Some(slot) = self.slots.get_mut(place) {
            *slot = Some(element);
            self.len = self.len.wrapping_add(1);
        }
    }

    /// Puts the element before the oldest one. A full queue drops it.
    pub(crate) fn push_front(&mut self, element: T) {
        if self.is_full() {
            return;
        }
        // The capacity is not 0 here.
        let head = self.place(CAPACITY.wrapping_sub(1));
        if let Some(slot) = self.slots.get_mut(head) {
            *slot = Some(element);
            self.head = head;
            self.len = self.len.wrapping_add(1);
        }
    }

    pub(crate) fn pop_front(&mut self) -> Option<T> {
        let element = self.slots.get_mut(self.head)?.take()?;
        self.head = self.place(1);
        self.len = self.len.wrapping_sub(1);
        Some(element)
    }

    pub(crate) fn pop_back(&mut self) -> Option<T> {
        let last = self.place(self.len.checked_sub(1)?);
        let element = self.slots.get_mut(last)?.take()?;
        self.len = self.len.wrapping_sub(1);
        Some(element)
    }

    pub(crate) fn get(&self, offset: usize) -> Option<&T> {
        if offset >= self.len {
            return None;
        }
        self.slots.get(self.place(offset))?.as_ref()
    }

    pub(crate) fn get_mut(&mut self, offset: usize) -> Option<&mut T> {
        if offset >= self.len {
            return None;
        }
        let place = self.place(offset);
        self.slots.get_mut(place)?.as_mut()
    }

    pub(crate) fn front(&self) -> Option<&T> {
        self.slots.get(self.head)?.as_ref()
    }

    pub(crate) fn back(&self) -> Option<&T> {
        self.get(self.len.checked_sub(1)?)
    }

    pub(crate) fn clear(&mut self) {
        while self.pop_front().is_some() {}
    }
}
