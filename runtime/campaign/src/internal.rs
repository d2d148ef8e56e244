//! Faults of hrdsl itself: a panic becomes an [`InternalError`], so that it costs the one thing that was being done.

use std::{
    cell::RefCell,
    fmt,
    panic::{AssertUnwindSafe, PanicHookInfo, catch_unwind, set_hook},
    sync::{Mutex, PoisonError},
};

/// What hrdsl found wrong with itself, and where in its sources.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct InternalError {
    pub message: String,
    /// `runtime/ta/src/store.rs:12:5`; empty without [`record_panics`].
    pub place: String,
}

impl fmt::Display for InternalError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "internal error: {}", self.message)?;
        if self.place.is_empty() { Ok(()) } else { write!(f, " ({})", self.place) }
    }
}

thread_local! {
    /// The last one of this thread.
    static OWN: RefCell<Option<InternalError>> = const { RefCell::new(None) };
}

/// The first one of a thread that nobody guards.
static FIRST: Mutex<Option<InternalError>> = Mutex::new(None);

/// Lets panics be kept with their places instead of printed; for the whole process.
pub fn record_panics() {
    set_hook(Box::new(|info| {
        let error = InternalError {
            message: message(info),
            place: info.location().map(ToString::to_string).unwrap_or_default(),
        };
        FIRST.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert_with(|| error.clone());
        OWN.with(|own| *own.borrow_mut() = Some(error));
    }));
}

fn message(info: &PanicHookInfo<'_>) -> String {
    info.payload_as_str().unwrap_or("something that is no text").to_owned()
}

/// Does this, and gives the fault of hrdsl that ended it, be it of a thread that it waited for.
///
/// What was being changed at that moment is in no defined state: the caller drops it.
///
/// # Errors
/// The panic.
pub fn guarded<T>(work: impl FnOnce() -> T) -> Result<T, InternalError> {
    catch_unwind(AssertUnwindSafe(work)).map_err(|payload| {
        // Of several the first says most: the others may be those who waited for it.
        let own = OWN.with(|own| own.borrow_mut().take());
        let first = FIRST.lock().unwrap_or_else(PoisonError::into_inner).take();
        first.or(own).unwrap_or_else(|| {
            let text = payload.downcast_ref::<&str>().map(|s| (*s).to_owned());
            let text = text.or_else(|| payload.downcast_ref::<String>().cloned());
            InternalError { message: text.unwrap_or_default(), place: String::new() }
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_is_an_error_with_its_place() {
        assert_eq!(guarded(|| 1 + 1), Ok(2));
        let plain = guarded(|| -> u8 { panic!("odd {}", 3) }).unwrap_err();
        assert_eq!(plain, InternalError { message: "odd 3".into(), place: String::new() });
        assert_eq!(plain.to_string(), "internal error: odd 3");
        let before = std::panic::take_hook();
        record_panics();
        let placed = guarded(|| -> u8 { panic!("even") });
        let joined = guarded(|| std::thread::scope(|s| s.spawn(|| panic!("inside")).join().unwrap()));
        set_hook(before);
        let placed = placed.unwrap_err();
        assert!(placed.place.starts_with(file!()), "{placed:?}");
        assert_eq!(placed.message, "even");
        assert_eq!(joined.unwrap_err().message, "inside");
        assert_eq!(guarded(|| ()), Ok(()));
    }
}
