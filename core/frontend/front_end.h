#pragma once
// Front end (paper 5.1, Fig. 2; method section 3): carries points by KLT from left(k-1) to left(k), from the place
// predicted by the motion of the body each belongs to, and along the row to right(k); anchors them to kept reference
// images; starts new ones by SURF where the view, or a body's outline, has too few; bridges a loss by SURF.
// Two matched clouds with persistent track ids result. Thread-bound. Bounded by max_points and the detector's cap.

#include <vector>

#include "core/base/side_worker.h"
#include "core/frontend/frame_images.h"
#include "core/frontend/klt.h"
#include "core/frontend/stereo_match.h"
#include "core/frontend/surf.h"
#include "core/frontend/surf_match.h"
#include "core/frontend/track.h"

namespace pelorus {

struct FrontEndConfig {
  KltConfig klt;
  StereoMatchConfig stereo;
  // All maxima, or nearly: the strongest alone would leave a dim sea floor beside a bright hull without points.
  SurfConfig surf{.max_points = 6000};
  SurfMatchConfig surf_match;
  int max_points = 750;
  int cell_columns = 16;
  int cell_rows = 12;
  double min_distance_px = 12.0;        // between points of the background
  double min_distance_object_px = 7.0;  // inside the outline of a body
  int max_points_per_object = 70;
  double forward_backward_px = 0.4;  // of tracks that no reference image confirms
  double min_disparity_px = 0.7;
  double reference_agreement_px = 1.0;  // place by reference against place by previous frame
  double reference_min_ncc = 0.85;
  double slope_radius_px = 70.0;  // neighbours that tell the slope of the surface around a point
  double max_slope = 0.15;        // disparity change per pixel above which an edge lies between two points
  int reference_spacing = 5;      // frames between kept images
  int reference_images = 8;
  double refill_below = 0.85;       // detect again when fewer than this share of max_points live
  int refill_every = 3;             // and at the latest after this many frames
  int bridge_points = 1500;         // strongest points described to bridge a loss
  double bridge_radius_px = 250.0;  // how far SURF looks for a lost point
  double bridge_below = 0.35;       // share of points surviving KLT under which SURF bridges the loss
};

// Predicted apparent motion of a body for the coming step.
struct BodyPrediction {
  BodyId body;
  Rigid3 H_curr_prev = Rigid3::Identity();
};

// Where refill starts more points.
struct RefillArea {
  std::array<OutlinePoint, 16> outline{};
  int outline_size = 0;
  int points_inside = 0;  // already there
};

// A search from one place to the neighbourhood of another.
[[nodiscard]] inline KltTask task_between(double u_from_px, double v_from_px, double u_to_px, double v_to_px) {
  KltTask task;
  task.u_from_px = static_cast<float>(u_from_px);
  task.v_from_px = static_cast<float>(v_from_px);
  task.u_to_px = static_cast<float>(u_to_px);
  task.v_to_px = static_cast<float>(v_to_px);
  return task;
}

// Threads lent to the front end: `tracking` takes half of each search, `surf` detects while the step goes on.
struct FrontEndWorkers {
  SideWorker& tracking;
  SideWorker& surf;
};

class FrontEnd {
 public:
  FrontEnd(const FrontEndConfig& config, const StereoRig& rig, const FrontEndWorkers& workers);
  ~FrontEnd() { workers_.surf.wait(); }
  FrontEnd(const FrontEnd&) = delete;
  FrontEnd& operator=(const FrontEnd&) = delete;

  struct Counts {
    int tracked = 0;
    int lost = 0;
    int bridged = 0;
    int started = 0;
    bool refilled = false;
  };

  // Carries all points into `frame`. predictions[0] must be the world's; unknown points start from it.
  // The pairs are valid until the next call; pair i belongs to track_of_pair(i). `may_refill` off: detection is spared
  // unless points cannot be found otherwise. refill() must follow, before the frame's images go.
  [[nodiscard]] PointPairs run(const StereoFrame& frame, std::span<const BodyPrediction> predictions,
                               bool may_refill = true);
  // What the step found: the body of each pair (kNoBody = unexplained) and its measured motion, used to carry the
  // anchors' warps. `motions` holds the step's H_curr_prev of every body named.
  void settle(std::span<const BodyId> body_of_pair, std::span<const BodyPrediction> motions);
  // Starts points on the current pair where there are too few; they become pairs with the next frame. `force`: even if
  // run() was told to spare it.
  void refill(std::span<const RefillArea> areas, bool force);
  // Forgets tracks for good (they proved to be outliers).
  void drop(std::span<const TrackId> tracks);

  // Pixel deviation of all points and of the present pairs.
  void set_sigma(double sigma_px);

  [[nodiscard]] std::span<const Track> tracks() const { return tracks_; }
  [[nodiscard]] std::span<Track> tracks() { return tracks_; }
  [[nodiscard]] Track& track_of_pair(PointIndex pair);
  [[nodiscard]] const Counts& counts() const { return counts_; }

 private:
  void take_images(const StereoFrame& frame);
  void build_right();
  // KLT on this thread and the tracking worker, half of the tasks each.
  void track(std::span<KltTask> tasks, const ImagePyramid& from, const ImagePyramid& to, KltSearch search,
             int coarsest_level, bool predicted = false);
  void track_share();
  void match_share();
  void detect_now();
  void describe_starts();
  void carry_left(std::span<const BodyPrediction> predictions);
  void retry_lost();
  void detect();
  void bridge_by_surf();
  void check_backward();
  void refine_by_reference();
  void carry_right(std::span<const BodyPrediction> predictions);
  void build_pairs();
  void measure_slopes();
  void renew_references();
  [[nodiscard]] int free_slot();
  [[nodiscard]] bool wants_refill() const;
  void choose_starts(std::span<const RefillArea> areas);
  void start_points();

  FrontEndConfig config_;
  StereoRig rig_;
  FrontEndWorkers workers_;
  Klt klt_;
  StereoMatcher stereo_;
  Surf surf_;
  SurfMatcher surf_matcher_;
  FrameImages images_;
  std::vector<Track> tracks_;
  std::vector<PointPair> pairs_;
  std::vector<std::size_t> track_of_pair_;
  std::vector<KltTask> left_tasks_;   // one per track
  std::vector<KltTask> work_tasks_;   // subset passed to the tracker
  std::vector<std::size_t> work_of_;  // the track of each work task
  std::span<const SurfPoint> detected_points_;
  std::vector<SurfPoint> starts_;
  std::vector<SurfPoint> lost_points_;
  std::vector<SurfDescriptor> lost_descriptors_;
  std::vector<SurfDescriptor> descriptors_;
  std::vector<StereoTask> stereo_tasks_;
  struct SlopePoint {  // what measure_slopes() needs of a pair
    Eigen::Vector2d px;
    double disparity_px;
    BodyId body;
    std::size_t pair;
  };
  std::vector<SlopePoint> by_column_;
  std::vector<int> cell_counts_;
  std::vector<int> area_counts_;
  std::uint64_t next_track_ = 1;
  int frames_ = 0;
  int frames_since_refill_ = 0;
  int frames_since_reference_ = 0;
  bool may_refill_ = true;
  bool will_refill_ = false;  // known from the start: detection runs beside the step
  bool detected_ = false;     // the detector was given the current left image, and may still be at it
  StereoFrame frame_;         // of the caller, valid during the step
  struct Share {              // what the tracking worker works on
    const ImagePyramid* from = nullptr;
    const ImagePyramid* to = nullptr;
    std::span<KltTask> tasks;
    KltSearch search = KltSearch::plane;
    int coarsest_level = 0;
    bool predicted = false;
    std::span<StereoTask> stereo_tasks;
  };
  Share share_;
  Counts counts_;
};

}  // namespace pelorus
