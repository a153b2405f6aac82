use crate::recognition::model::{Gathered, Model, ModelError, ModelHead, ShapeCount};
use crate::sweep::{Shard, ShardOrderError};

/// The shards of a training that were added so far. Memory holds only what is already merged and one shard.
#[derive(Debug, Default)]
pub struct ModelMerge {
    head: Option<ModelHead>,
    gathered: Gathered,
}

impl ModelMerge {
    /// Adds the next shard: the first, then the second, and so on.
    ///
    /// # Errors
    /// Returns an error if it is not the next one, or of another training than the first. The merge then stays
    /// unchanged.
    pub fn add(&mut self, model: &Model) -> Result<(), ModelError> {
        let shard = model.shard();
        // Everything is checked before anything changes: after a refusal, the right shard can still be added.
        if let Some(head) = &self.head
            && !model.head().same_training(head)
        {
            return Err(ModelError::Foreign { shard });
        }
        shard.check_after(self.head.as_ref().map(|head| head.shard))?;
        match &mut self.head {
            None => self.head = Some(model.head().clone()),
            Some(head) => {
                let poses = head.poses.checked_add(model.poses());
                head.poses = poses.ok_or(ModelError::Parts("counts beyond any number of poses"))?;
                head.shard = shard;
                for (sum, cut) in head.cut.iter_mut().zip(model.cut()) {
                    *sum += cut;
                }
            }
        }
        for index in 0..model.keys().len() {
            let slot = self.gathered.slot(model.keys(), index);
            for &count in model.counts(index) {
                slot_add(&mut self.gathered.counts[slot], count);
            }
        }
        Ok(())
    }

    /// Returns the model of all shards.
    ///
    /// # Errors
    /// Returns an error if some or all are missing.
    pub fn finish(self) -> Result<Model, ModelError> {
        let mut head = self.head.ok_or(ShardOrderError::Nothing)?;
        head.shard.check_last()?;
        head.shard = Shard::WHOLE;
        let Gathered { keys, counts } = self.gathered;
        Model::of_table(head, &keys, |index| counts[index].iter().copied())
    }
}

/// Adds a count to the counts of a key, which stay in the order of the shapes.
fn slot_add(counts: &mut Vec<ShapeCount>, more: ShapeCount) {
    match counts.binary_search_by_key(&more.shape, |count| count.shape) {
        Ok(index) => counts[index].poses += more.poses,
        Err(index) => counts.insert(index, more),
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn examples() -> Result<(), Box<dyn std::error::Error>> {
        use crate::recognition::{GridSteps, ModelMerge, Training, equal_figures};
        use crate::sweep::Shard;
        let training = Training::fitting(equal_figures(), GridSteps::new(4, 45)?)?;
        let mut merge = ModelMerge::default();
        for number in 1..=2 {
            let shard = Shard::new(number, 2).unwrap();
            merge.add(&training.clone().with_shard(shard).run()?)?;
        }
        assert_eq!(merge.finish()?, training.run()?);
        Ok(())
    }
}
