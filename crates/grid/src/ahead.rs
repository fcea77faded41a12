//! Memory that will be needed soon.

/// Bytes that are brought at once.
#[cfg(target_arch = "x86_64")]
const LINE: usize = 64;

/// Asks the processor to bring memory near while it does other things. Where it cannot be asked, nothing happens.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Ahead {
    #[cfg(target_arch = "x86_64")]
    sse: Option<pulp::core_arch::x86::Sse>,
}

impl Ahead {
    pub(crate) fn new() -> Self {
        Self {
            #[cfg(target_arch = "x86_64")]
            sse: pulp::core_arch::x86::Sse::try_new(),
        }
    }

    /// Brings all that something holds itself into the nearest cache.
    #[inline]
    pub(crate) fn fetch<T: ?Sized>(self, what: &T) {
        #[cfg(target_arch = "x86_64")]
        if let Some(sse) = self.sse {
            let first = std::ptr::from_ref(what).cast::<i8>();
            for at in (0..size_of_val(what)).step_by(LINE) {
                sse._mm_prefetch::<{ std::arch::x86_64::_MM_HINT_T0 }>(first.wrapping_add(at));
            }
        }
        #[cfg(not(target_arch = "x86_64"))]
        let _ = (self, what);
    }
}
