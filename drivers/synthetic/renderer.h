#pragma once
// Renders stereo pairs of a scene by ray casting, with exact geometry: one ray through the centre of every pixel
// (integer coordinates) whose texture is band-limited to the pixel, eight where surfaces meet. Any frame can be
// rendered at any time; the bytes depend on scene and frame only. Thread-bound (uses several threads inside).

#include <vector>

#include "core/base/image.h"
#include "drivers/synthetic/film.h"
#include "drivers/synthetic/scene.h"
#include "drivers/synthetic/seafloor.h"
#include "drivers/synthetic/solids.h"
#include "drivers/synthetic/surface_texture.h"

namespace pelorus::synthetic {

class Renderer {
 public:
  // threads 0: as many as the hardware has.
  explicit Renderer(const Scene& scene, int threads = 0);

  void render(int frame, Image& left, Image& right);
  // Of the last frame: left pixels on each body of the scene, in its order.
  [[nodiscard]] const std::vector<int>& visible_px() const { return visible_px_; }
  [[nodiscard]] const Film& left_film() const { return film_[0]; }

 private:
  struct View;
  void render_view(const View& view, Film& film);
  void trace_row(const View& view, int v, Film& film) const;
  void smooth_edges(const View& view, int v, Film& film) const;
  void shade(const View& view, RayBatch& batch) const;
  void count_visible();

  Scene scene_;
  int threads_;
  Seafloor floor_;
  SurfaceTexture texture_;
  std::vector<Solid> rocks_;
  Film film_[2];
  std::vector<int> visible_px_;
};

}  // namespace pelorus::synthetic
