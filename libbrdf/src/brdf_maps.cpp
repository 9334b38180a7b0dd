#include <brdf/brdf_maps.h>

#include <brdf/brdf_properties.h>

#include <wavelet/base/cpu_clones.h>
#include <wavelet/base/elementary.h>
#include <wavelet/base/hash.h>
#include <wavelet/square/sphere_map.h>

#include <algorithm>
#include <cassert>
#include <cstdint>
#include <numbers>
#include <vector>

namespace haarlight::brdf {
namespace {

using wavelet::Fold;
using wavelet::Map;

// The arithmetic of many samples at once.

/// Samples of one map; place_samples() fills the second half from the first.
struct SampleBatch {
  float middle_wo[3] = {0, 0, 1}; ///< ω_o for the middle normal of the cell
  int count = 0;
  float u[batch_capacity], v[batch_capacity]; ///< square coordinates of ω
  float spacing[batch_capacity];              ///< width of the area of a sample, radians
  float normal[3][batch_capacity];

  float cosine[batch_capacity];     ///< n·ω
  float resolution[batch_capacity]; ///< over one: the sample is too coarse for the table there
  HalfDifferenceBatch angles;       ///< of ω and ω_o, the mirror image of z about n
};

/// Bin k of θ_h ends at the angle k² / bins2_per_radian.
constexpr float bins2_per_radian = 8100.0F * 2.0F / pi;
/// The widest step of θ_h between samples, in bins, squared: a part for the peak and one that grows
/// with the distance from it, where tables are smooth. Radians².
constexpr float step2_at_peak = 0.03F;
constexpr float step2_per_radian = 4.0F;
/// At grazing angles lobes are cos θ_d times as wide; narrower ones than at this cosine are not
/// resolved.
constexpr float lowest_cosine_d = 0.3F;

/// Square of the sample spacing over the spacing that the table needs, the same for all normals of
/// the cell: if finer samples were for some normals only, the average would lean towards the
/// others. θ_h is at least half the angle between ω and z. A bin of θ_h is about (2k + 1) /
/// bins2_per_radian wide; a step of θ_h is one of 2 cos θ_d in ω across the plane of incidence, and
/// of 2 in it.
inline float needed_resolution(float z, float wi_wo, float spacing) {
  const float cosine_d2 = larger(0.5F + 0.5F * wi_wo, lowest_cosine_d * lowest_cosine_d);
  const float theta_h = larger(square_root(larger(0.5F - 0.5F * z, 0.0F)) - 0.4F * spacing, 0.0F);
  const float bins2 = step2_at_peak + step2_per_radian * theta_h;
  return spacing * spacing * (0.25F * bins2_per_radian * bins2_per_radian) /
         (cosine_d2 * bins2 * (4.0F * bins2_per_radian * theta_h + 1.0F));
}

/// With c = n·z, ω_o = 2c n − z, so that H = ω + ω_o = (ω − z) + 2c n: the component of H across n
/// is that of the small vector ω − z, without cancellation.
HAARLIGHT_CPU_CLONES void place_samples(SampleBatch& b) {
  HalfDifferenceBatch& angles = b.angles;
  for (int i = 0; i < b.count; ++i) {
    float x = 0;
    float y = 0;
    float z = 0;
    wavelet::square_to_sphere(b.u[i], b.v[i], x, y, z);
    const float nx = b.normal[0][i];
    const float ny = b.normal[1][i];
    const float nz = b.normal[2][i];
    const float cosine = x * nx + y * ny + z * nz;
    const float dz = z - 1.0F;
    const float along = x * nx + y * ny + dz * nz;
    const float ax = x - along * nx;
    const float ay = y - along * ny;
    const float az = dz - along * nz;
    const float wi_wo = 2.0F * nz * cosine - z;
    const float h_length = square_root(larger(2.0F + 2.0F * wi_wo, 0.0F));
    b.cosine[i] = cosine;
    angles.theta_h_y[i] = square_root(ax * ax + ay * ay + az * az);
    angles.theta_h_x[i] = cosine + nz;
    angles.theta_d_y[i] = square_root(larger(2.0F - 2.0F * wi_wo, 0.0F));
    angles.theta_d_x[i] = h_length;
    angles.phi_d_y[i] = 2.0F * (nx * y - ny * x);
    angles.phi_d_x[i] = h_length * (nz - cosine);
    const float middle_wi_wo = x * b.middle_wo[0] + y * b.middle_wo[1] + z * b.middle_wo[2];
    b.resolution[i] = needed_resolution(z, middle_wi_wo, b.spacing[i]);
  }
  angles.count = b.count;
}

// A map is filled from a quadtree of samples, evaluated in batches.

/// Range of reflection angles and rolls of one map, radians.
struct ReflectionCell {
  double theta_begin, theta_end;
  double phi_begin, phi_end;
};

/// Averages f_r over a map's pixels. A square of the domain takes 2 × 2 samples; a sample that is
/// wider than the table's bins allow there is replaced by those of its quarter, and so on. Every
/// sample has its own normal from the cell: quarters of the cell's range of θ_r go to the four
/// samples of a square, sixteenths to those of four squares (a radical inverse of the path down the
/// tree), and φ follows θ_r as in a Hammersley set.
class MapKernel {
public:
  /// @param supersample samples along a pixel's side at least
  /// @param cosine      whether to include max(0, n·ω)
  MapKernel(const MeasuredBrdf& brdf, const ReflectionCell& cell, int supersample, bool cosine);

  Map make(int size) const;

private:
  static constexpr int normal_count = 256;

  /// A square whose samples are pending.
  struct Square {
    float u, v, side;    ///< corner and size
    float offset;        ///< place in the cell, in [0, 1); its samples get (order + offset) / 4
    float weight;        ///< of each of its samples in the pixel's average
    std::uint32_t pixel; ///< y · size + x
    std::uint32_t order; ///< which quarter of the cell goes to which sample
  };
  struct Job;

  void push_tile(Job& job, int tile_x, int tile_y) const;
  bool below_horizon(float u, float v, float side) const;
  void take_samples(Job& job) const;
  void accumulate_samples(Job& job) const;
  static void split(Job& job, const Square& parent, int sample);

  const MeasuredBrdf& m_brdf;
  int m_supersample;
  bool m_cosine;
  float m_cell_radius; ///< angle from the middle normal to the farthest
  Vec3 m_middle;
  float m_normals[3][normal_count]; ///< by offset within the cell of θ_r
};

constexpr int tile_size = 8; // pixels
constexpr int squares_per_batch = batch_capacity / 4;
constexpr float smallest_side = 1.0F / (1 << 18);
/// Width of a square of the domain, radians, over its side: the root of 4π.
constexpr float width_per_side = 3.5449077F;
/// Bound of the angle between the middle of a square and its farthest corner, over its width.
constexpr float radius_per_width = 1.21F;

/// The bits of i < 256 in reverse order, over 256.
double radical_inverse(int i) {
  int reversed = 0;
  for (int bit = 0; bit < 8; ++bit)
    reversed |= ((i >> bit) & 1) << (7 - bit);
  return reversed / 256.0;
}

constexpr float orders[4][4] = {{0, 2, 3, 1}, {2, 0, 1, 3}, {3, 1, 0, 2}, {1, 3, 2, 0}};

Eigen::Vector3d normal_at(double theta_r, double phi) {
  const SineCosine t = sine_cosine(theta_r);
  const SineCosine p = sine_cosine(phi);
  return {t.sine * p.cosine, t.sine * p.sine, t.cosine};
}

/// A map under construction.
struct MapKernel::Job {
  Map map;
  std::vector<Float4> sums; ///< by pixel
  std::vector<Square> pending;
  SampleBatch batch;
  Square taken[squares_per_batch]; ///< those whose samples are in the batch

  explicit Job(int size)
      : map(size), sums(static_cast<std::size_t>(size) * static_cast<std::size_t>(size)) {}
};

MapKernel::MapKernel(const MeasuredBrdf& brdf, const ReflectionCell& cell, int supersample,
                     bool cosine)
    : m_brdf(brdf), m_supersample(supersample), m_cosine(cosine), m_normals() {
  const double theta_step = cell.theta_end - cell.theta_begin;
  const double phi_step = cell.phi_end - cell.phi_begin;
  m_cell_radius = static_cast<float>(0.5 * (theta_step + phi_step));
  m_middle =
      normal_at(cell.theta_begin + 0.5 * theta_step, cell.phi_begin + 0.5 * phi_step).cast<float>();
  for (int i = 0; i < normal_count; ++i) {
    const Eigen::Vector3d n =
        normal_at(cell.theta_begin + theta_step * (i + 0.5) / normal_count,
                  cell.phi_begin + phi_step * (radical_inverse(i) + 0.5 / normal_count));
    for (int axis = 0; axis < 3; ++axis)
      m_normals[axis][i] = static_cast<float>(n[axis]);
  }
}

/// Whether the square lies below the horizon for every normal of the cell.
bool MapKernel::below_horizon(float u, float v, float side) const {
  const Vec3 w = wavelet::square_to_sphere({u + 0.5F * side, v + 0.5F * side});
  return w.dot(m_middle) < -(radius_per_width * width_per_side * side + m_cell_radius);
}

void MapKernel::push_tile(Job& job, int tile_x, int tile_y) const {
  const int size = job.map.size;
  const float side = 1.0F / static_cast<float>(size);
  for (int y = tile_y; y < std::min(tile_y + tile_size, size); ++y) {
    for (int x = tile_x; x < std::min(tile_x + tile_size, size); ++x) {
      const auto pixel = static_cast<std::uint32_t>(y * size + x);
      const std::uint32_t bits = hash_bits(pixel);
      job.pending.push_back({static_cast<float>(x) * side, static_cast<float>(y) * side, side,
                             static_cast<float>(bits >> 8U) * 0x1p-24F, 0.25F, pixel, bits & 3U});
    }
  }
}

/// Fills the batch with four samples for each of the last squares of the list.
void MapKernel::take_samples(Job& job) const {
  const auto squares = std::min<std::size_t>(job.pending.size(), squares_per_batch);
  SampleBatch& b = job.batch;
  b.count = static_cast<int>(4 * squares);
  int i = 0;
  for (std::size_t k = 0; k < squares; ++k) {
    const Square& s = job.taken[k] = job.pending.back();
    job.pending.pop_back();
    for (int quarter = 0; quarter < 4; ++quarter, ++i) {
      b.u[i] = s.u + s.side * ((quarter & 1) != 0 ? 0.75F : 0.25F);
      b.v[i] = s.v + s.side * ((quarter & 2) != 0 ? 0.75F : 0.25F);
      b.spacing[i] = 0.5F * width_per_side * s.side;
      const float offset = 0.25F * (orders[s.order][quarter] + s.offset);
      // Far down the tree the offset may round to one.
      const int place = std::min(static_cast<int>(offset * normal_count), normal_count - 1);
      for (int axis = 0; axis < 3; ++axis)
        b.normal[axis][i] = m_normals[axis][place];
    }
  }
}

/// Splits the samples that are too coarse, and adds the others to their pixels.
void MapKernel::accumulate_samples(Job& job) const {
  SampleBatch& b = job.batch;
  const float widest = width_per_side / static_cast<float>(job.map.size * m_supersample);
  float factors[batch_capacity];
  std::uint32_t pixels[batch_capacity];
  int accumulated = 0;
  for (int i = 0; i < b.count; ++i) {
    const Square& s = job.taken[i / 4];
    // Its children would have other normals, hence the wide margin.
    if (b.cosine[i] < -(radius_per_width * b.spacing[i] + 2 * m_cell_radius))
      continue;
    if (b.spacing[i] > widest * 1.001F || (b.resolution[i] > 1 && s.side > smallest_side)) {
      split(job, s, i);
    } else if (b.cosine[i] > 0) {
      if (i != accumulated)
        b.angles.move(i, accumulated);
      factors[accumulated] = s.weight * (m_cosine ? b.cosine[i] : 1.0F);
      pixels[accumulated++] = s.pixel;
    }
  }
  b.angles.count = accumulated;
  Float4 values[batch_capacity];
  m_brdf.evaluate(b.angles, values);
  for (int i = 0; i < accumulated;) {
    const std::uint32_t pixel = pixels[i];
    Float4 sum = job.sums[pixel];
    for (; i < accumulated && pixels[i] == pixel; ++i)
      sum += values[i] * factors[i];
    job.sums[pixel] = sum;
  }
}

/// Queues the quadrant of `parent` that sample i of the batch represents.
void MapKernel::split(Job& job, const Square& parent, int i) {
  const float half = 0.5F * parent.side;
  job.pending.push_back({job.batch.u[i] - 0.5F * half, job.batch.v[i] - 0.5F * half, half,
                         0.25F * (orders[parent.order][i % 4] + parent.offset),
                         0.25F * parent.weight, parent.pixel, parent.order});
}

Map MapKernel::make(int size) const {
  Job job(size);
  Eigen::Map<Vec3>(job.batch.middle_wo) = mirror(Vec3::UnitZ(), m_middle);
  const float side = 1.0F / static_cast<float>(size);
  for (int y = 0; y < size; y += tile_size) {
    for (int x = 0; x < size; x += tile_size) {
      if (below_horizon(static_cast<float>(x) * side, static_cast<float>(y) * side,
                        side * tile_size))
        continue;
      push_tile(job, x, y);
      while (!job.pending.empty()) {
        take_samples(job);
        place_samples(job.batch);
        accumulate_samples(job);
      }
    }
  }
  for (std::size_t i = 0; i < job.sums.size(); ++i)
    for (std::size_t c = 0; c < 3; ++c)
      job.map.rgb[3 * i + c] = job.sums[i][static_cast<int>(c)];
  return std::move(job.map);
}

// The set of maps.

constexpr int largest_size = 8192;

Fold fold_of(const BrdfMapOptions& options) {
  if (options.fold)
    return *options.fold;
  return options.roll > 1 && options.roll % 4 == 0 ? Fold::Rotations : Fold::None;
}

/// Defaults filled in.
BrdfMapOptions complete(BrdfMapOptions options) {
  if (options.size == 0)
    options.size = options.roll == 1 ? 512 : 128;
  options.fold = fold_of(options);
  return options;
}

int stored_rows(const BrdfMapOptions& options) {
  const int parts = *options.fold == Fold::Mirrors ? 8 : *options.fold == Fold::Rotations ? 4 : 1;
  return options.roll / parts;
}

const char* fold_name(Fold fold) {
  return fold == Fold::Mirrors ? "mirrors" : fold == Fold::Rotations ? "rotations" : "none";
}

/// The map of roll φ + π/2 from that of roll φ: ω rotates by 90° about z, from +x to +y.
Map rotate_quarter(const Map& map) {
  Map turned(map.size);
  for (int y = 0; y < map.size; ++y)
    for (int x = 0; x < map.size; ++x)
      turned.set(map.size - 1 - y, x, map.at(x, y));
  return turned;
}

const char* const frame_convention =
    "z = mirror direction of omega_o about the normal n; n = (sin theta_r cos phi, sin theta_r sin "
    "phi, "
    "cos theta_r); column c covers theta_r in [c, c+1) * (pi/2) / columns; row r covers phi in "
    "[r, r+1) * 2 pi / rolls, or is phi = 0 if there is one roll";

} // namespace

std::optional<std::string> validate(const BrdfMapOptions& options) {
  const BrdfMapOptions o = complete(options);
  if (o.size < 2 || o.size > largest_size || (o.size & (o.size - 1)) != 0)
    return "map size must be a power of two from 2 to " + std::to_string(largest_size);
  if (o.theta < 1 || o.roll < 1 || o.supersample < 1)
    return "theta, roll and supersample must be at least 1";
  if (*o.fold == Fold::Rotations && o.roll % 4 != 0)
    return "folding by rotations needs a multiple of 4 rolls";
  if (*o.fold == Fold::Mirrors && o.roll % 8 != 0)
    return "folding by mirrors needs a multiple of 8 rolls";
  return std::nullopt;
}

BrdfMaps::BrdfMaps(MeasuredBrdf brdf, const BrdfMapOptions& options)
    : m_brdf(std::move(brdf)), m_options(complete(options)),
      m_albedos(static_cast<std::size_t>(options.theta)) {
  assert(!validate(options));
  describe(m_options);
  if (*m_options.fold == Fold::Mirrors)
    m_brdf = m_brdf.symmetrised();
}

void BrdfMaps::describe(const BrdfMapOptions& options) {
  m_info.kind = wavelet::SetKind::Brdf;
  m_info.size = options.size;
  m_info.columns = options.theta;
  m_info.rows = stored_rows(options);
  m_info.rolls = options.roll;
  m_info.fold = *options.fold;
  m_info.cosine = options.cosine;
  m_info.frame = frame_convention;
  m_info.units = "sr^-1";
  Provenance& provenance = m_info.provenance;
  provenance.set("source", m_brdf.name());
  provenance.set("source_hash", m_brdf.hash());
  provenance.set("lookup", lookup_name(m_brdf.lookup()));
  provenance.set("fold", fold_name(*options.fold));
  provenance.set("supersample", std::to_string(options.supersample));
  provenance.set("version", version_text());
}

Map BrdfMaps::sample(int column, int row) const {
  const double theta_step = std::numbers::pi / 2 / m_options.theta;
  const double phi_step = 2 * std::numbers::pi / m_options.roll;
  const bool rolls = m_options.roll > 1;
  const ReflectionCell cell{column * theta_step, (column + 1) * theta_step,
                            rolls ? row * phi_step : 0, rolls ? (row + 1) * phi_step : 0};
  return MapKernel(m_brdf, cell, m_options.supersample, m_options.cosine).make(m_options.size);
}

Map BrdfMaps::make(int column, int row) const {
  assert(column >= 0 && column < m_info.columns && row >= 0 && row < m_info.rows);
  const int rolls = m_options.roll;
  const int quarter = rolls % 4 == 0 ? rolls / 4 : rolls;
  Map map = sample(column, row % quarter);
  for (int turn = row / quarter; turn > 0; --turn)
    map = rotate_quarter(map);
  return map;
}

std::optional<Rgb> BrdfMaps::integral(int column, int /*row*/) const {
  Albedo& albedo = m_albedos[static_cast<std::size_t>(column)];
  std::call_once(albedo.once, [&] {
    const double step = std::numbers::pi / 2 / m_options.theta;
    albedo.value = directional_albedo(m_brdf, column * step, (column + 1) * step, m_options.cosine);
  });
  return albedo.value;
}

} // namespace haarlight::brdf
