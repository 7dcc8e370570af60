//! Memory for the numbers of long columns, in large pages where the system has them, as numpy has it. With small pages, touching them for
//! the first time took half of the time of an evaluation with all outputs; with large ones the system still clears them, a quarter of it.
//! So the pages of a column that nobody needs any more wait for the next one.

use arrow_buffer::{Buffer, ScalarBuffer};
use memmap2::MmapMut;
use std::collections::VecDeque;
use std::ptr::NonNull;
use std::sync::{Arc, Mutex, PoisonError};

/// Bytes from which on a column has pages of its own.
const LONG: usize = 4 << 20;
/// Bytes of pages that wait at most: more than all outputs of a million designs of a variator.
const MOST_WAITING: usize = 512 << 20;

/// The pages that wait; those that have waited longest go first.
static WAITING: Mutex<WaitingPages> = Mutex::new(WaitingPages(VecDeque::new()));

/// Pages that no column has at present.
struct WaitingPages(VecDeque<MmapMut>);

impl WaitingPages {
    /// Pages of at least so many bytes and not many more.
    fn take(&mut self, bytes: usize) -> Option<MmapMut> {
        let fits = |it: &MmapMut| (bytes..=bytes + bytes / 4).contains(&it.len());
        let place = self.0.iter().rposition(fits)?;
        self.0.remove(place)
    }

    /// Keeps pages if the system may take back what is in them where memory is short; elsewhere they are given back at once.
    fn put(&mut self, pages: MmapMut) {
        // SAFETY: nobody has the pages, so that what is in them may be lost.
        #[cfg(target_os = "linux")]
        let may_be_taken = unsafe { pages.unchecked_advise(memmap2::UncheckedAdvice::Free) }.is_ok();
        #[cfg(not(target_os = "linux"))]
        let may_be_taken = false;
        if !may_be_taken {
            return;
        }
        self.0.push_back(pages);
        while self.bytes() > MOST_WAITING {
            self.0.pop_front();
        }
    }

    fn bytes(&self) -> usize {
        self.0.iter().map(|it| it.len()).sum()
    }
}

/// The pages of a column, which wait for the next one when it goes.
pub struct ColumnPages(Option<MmapMut>);

impl ColumnPages {
    /// Pages of at least so many bytes, if the system has them.
    fn of(bytes: usize) -> Option<Self> {
        let mut waiting = WAITING.lock().unwrap_or_else(PoisonError::into_inner);
        let pages = waiting.take(bytes).or_else(|| {
            // A process may have a limit, of which pages that wait are a part.
            let pages = MmapMut::map_anon(bytes).or_else(|_| {
                waiting.0.clear();
                MmapMut::map_anon(bytes)
            });
            let pages = pages.ok()?;
            // A request that the system may refuse: then it only takes longer.
            #[cfg(target_os = "linux")]
            let _ = pages.advise(memmap2::Advice::HugePage);
            Some(pages)
        })?;
        Some(Self(Some(pages)))
    }

    fn bytes(&mut self) -> &mut [u8] {
        self.0.as_mut().expect("only who drops it takes them")
    }
}

impl Drop for ColumnPages {
    fn drop(&mut self) {
        if let Some(pages) = self.0.take() {
            WAITING.lock().unwrap_or_else(PoisonError::into_inner).put(pages);
        }
    }
}

/// Room for the numbers of a column; what stands there at first is of no worth.
pub enum ColumnRoom {
    Short(Vec<f64>),
    /// With the number of numbers.
    Long(ColumnPages, usize),
}

impl ColumnRoom {
    pub fn new(rows: usize) -> Self {
        let bytes = rows * size_of::<f64>();
        let pages = (bytes >= LONG).then(|| ColumnPages::of(bytes)).flatten();
        let Some(pages) = pages else { return Self::Short(vec![0.0; rows]) };
        Self::Long(pages, rows)
    }

    /// The numbers, to be written.
    pub fn numbers(&mut self) -> &mut [f64] {
        match self {
            Self::Short(numbers) => numbers,
            Self::Long(pages, rows) => bytemuck::cast_slice_mut(&mut pages.bytes()[..*rows * size_of::<f64>()]),
        }
    }

    /// The same memory as Arrow and numpy have it.
    pub fn into_buffer(self) -> ScalarBuffer<f64> {
        match self {
            Self::Short(numbers) => numbers.into(),
            Self::Long(mut pages, rows) => {
                let (bytes, start) = (rows * size_of::<f64>(), NonNull::from(&mut pages.bytes()[0]));
                // SAFETY: the pages are at least that long, and are where they are until the buffer drops what owns them.
                let buffer = unsafe { Buffer::from_custom_allocation(start, bytes, Arc::new(pages)) };
                ScalarBuffer::new(buffer, 0, rows)
            }
        }
    }
}
