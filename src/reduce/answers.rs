//! What an engine that hands over candidates is told of the answers so far, so that it can leave out what cannot be part of them.

/// What is known of the answers, in f64, as the reducers have it.
#[derive(Clone, Debug, Default)]
pub struct Answers {
    /// Keys of certified points of the front, point after point; less is better.
    pub front: Vec<f64>,
    /// Key and index of the worst of the best K, once there are K.
    pub top: Option<(f64, u64)>,
    /// Per objective: least and largest value with their indices.
    pub extremes: Vec<[Option<(f64, u64)>; 2]>,
    /// Of a sample of feasible designs: the largest place of its order that may still be part of it.
    pub last_place: Option<u64>,
    /// Per map of values, per cell: the best key.
    pub cells: Vec<Vec<f64>>,
}

impl Answers {
    /// Takes over what `other` knows better; the fronts stay apart.
    pub fn tighten(&mut self, other: &Self) {
        let better = |a: (f64, u64), b: (f64, u64)| a.0 < b.0 || (a.0 == b.0 && a.1 < b.1);
        if let Some(top) = other.top
            && self.top.is_none_or(|own| better(top, own))
        {
            self.top = Some(top);
        }
        if let Some(other) = other.last_place {
            self.last_place = Some(self.last_place.map_or(other, |own| own.min(other)));
        }
        for (own, other) in self.extremes.iter_mut().zip(&other.extremes) {
            for (side, (own, other)) in [1.0, -1.0].into_iter().zip(own.iter_mut().zip(other)) {
                let key = |(value, index): (f64, u64)| (side * value, index);
                if let Some(other) = other
                    && own.is_none_or(|own| better(key(*other), key(own)))
                {
                    *own = Some(*other);
                }
            }
        }
        for (own, other) in self.cells.iter_mut().flatten().zip(other.cells.iter().flatten()) {
            *own = own.min(*other);
        }
    }
}
