//! One case: a view of a scene in a mode, from rays to rows.

use rdh::{Accel, Spec};
use rdh_scene::View;

use super::build::{Built, Lesson};
use super::site::Site;
use super::trial::{Trial, in_pool};
use super::{Event, Prepared, Study};
use crate::integrate::{Mode, Shoot};
use crate::plan::{Case, Plan, Protocol, Source};

impl Study<'_, '_> {
    pub(super) fn case(&mut self, on: &Prepared<'_>, view: &View, mode: Mode) {
        let case = Case { scene: on.target.entry.id.clone(), view: view.name.clone(), frame: on.frame, mode };
        (self.observer)(&Event::Started { case: &case, done: self.done, total: self.total });
        let Some(first) = on.first() else {
            return self.fail_case(on, Some(&view.name), None, "no structure to make the rays with".to_owned());
        };
        let shoot = Shoot::new(&on.stage, mode, view, self.plan);
        let batches = in_pool(self.pool.as_ref(), || shoot.batches(first));
        let needs_rays: Vec<Spec> = self.plan.specs.iter().filter(|s| s.needs_rays()).copied().collect();
        let test_rays = batches.iter().map(|b| b.rays.len()).sum();
        let lesson = match self.lesson(on, &shoot, (view, mode), &needs_rays, test_rays) {
            Ok(lesson) => lesson,
            Err(reason) => return self.fail_case(on, Some(&view.name), None, reason),
        };
        let trained = self.build_all(on, Some(&view.name), &needs_rays, &lesson);
        let trees: Vec<&Built> = self.plan.specs.iter().filter_map(|s| find(&on.shared, &trained, s)).collect();
        let triangles = on.stage.mesh().len();
        let (kind, plan, pool) = (on.target.entry.kind, self.told(), self.pool.as_ref());
        let outcome = Trial { case: &case, kind, triangles, plan: &plan, pool }.run(&trees, &batches);
        for mismatch in outcome.mismatches {
            (self.observer)(&Event::Mismatch(&mismatch));
            self.document.mismatches.push(mismatch);
        }
        for row in outcome.rows.into_iter().flatten() {
            (self.observer)(&Event::Row(&row));
            self.document.rows.push(row);
        }
    }

    /// The rays that trees are built for.
    fn lesson(
        &self,
        on: &Prepared<'_>,
        shoot: &Shoot<'_>,
        (view, mode): (&View, Mode),
        needs_rays: &[Spec],
        test_rays: usize,
    ) -> Result<Lesson, String> {
        let Some(first) = on.first().filter(|_| !needs_rays.is_empty()) else { return Ok(Lesson::none()) };
        if let Some(source) = &self.plan.rrs {
            return self.site(on, first).lesson(source, view, mode);
        }
        Ok(Lesson::cast(shoot, first, test_rays, (view, on.frame)))
    }

    /// The plan as rows tell it: a part of the frame is chosen as the paper does.
    fn told(&self) -> Plan {
        let paper = matches!(self.plan.rrs, Some(Source::Frame(_)));
        Plan { protocol: if paper { Protocol::Paper } else { self.plan.protocol }, ..self.plan.clone() }
    }

    fn site<'s>(&'s self, on: &'s Prepared<'_>, first: &'s Accel) -> Site<'s> {
        let Prepared { target, frame, stage, views, .. } = on;
        Site { entry: &target.entry, frame: *frame, stage, first, views, plan: self.plan, load: self.load }
    }

    /// Builds some specs. Those that fail are told and left out.
    pub(super) fn build_all(
        &mut self,
        on: &Prepared<'_>,
        view: Option<&str>,
        specs: &[Spec],
        lesson: &Lesson,
    ) -> Vec<Built> {
        let mesh = on.stage.mesh();
        let wanted: Vec<(Spec, &Lesson)> = specs.iter().map(|&spec| (spec, lesson)).collect();
        let results = super::build_interleaved(mesh, &wanted, self.plan.builds_for(mesh.len()));
        let mut finished = Vec::new();
        for (result, &spec) in results.into_iter().zip(specs) {
            match result {
                Ok(built) => {
                    let scene = &on.target.entry.id;
                    (self.observer)(&Event::Built { scene, spec, secs: built.build_secs });
                    finished.push(built);
                }
                Err(reason) => self.fail_case(on, view, Some(spec), reason),
            }
        }
        finished
    }
}

fn find<'b>(shared: &'b [Built], trained: &'b [Built], spec: &Spec) -> Option<&'b Built> {
    shared.iter().chain(trained).find(|b| b.spec == *spec)
}
