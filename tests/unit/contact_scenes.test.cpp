// The scenes that contact is tested with start as they must.
#include "tests/contact_scenes.h"

#include "server/model/clean_start.h"
#include "server/model/stability.h"
#include "tests/scenes.h"

using namespace clothlab;

TEST_CASE("each scene of contact starts without crossings, at every size and thickness, and is stable") {
  for (const test::ContactScene& each : test::contact_scenes())
    for (const int size : {16, 33, 64})
      for (const double thickness : {0.002, 0.01}) {
        INFO(each.name << ", " << size << ", " << thickness << " m");
        const Result<scene::Document> document =
            scene::validate(each.document({size, thickness, 10.0, "symplectic_euler"}));
        INFO((document ? "" : document.error().text()));
        REQUIRE(document);
        CHECK(document->scene.name == each.name);
        scene::Scene scene = document->scene;
        scene.self_collision->kind = scene::ContactKind::surface;
        const Result<model::Model> model = model::build(scene);
        INFO((model ? "" : model.error().text()));
        REQUIRE(model);
        if (size == 16)
          CHECK(model::step_warning(scene.solver, model::dt_limit_bound(*model, scene)).empty());
      }
}
