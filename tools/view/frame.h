#pragma once
// Pictures of scenes and of transfer, drawn with GL in the context of the caller.

#include <view/gl.h>
#include <view/packing.h>
#include <view/view_scene.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace haarlight::view {

/// Each pixel uses the level of the trees that it needs.
inline constexpr int automatic_level = -1;

/// Default of ViewState::tolerance; HAARVIEW.md lists error and cost by tolerance.
inline constexpr float default_tolerance = 3e-3F;

/// Everything that a picture of a scene depends on, apart from the scene's shapes and trees.
struct ViewState {
  renderer::CameraDescription camera;
  int width = 1; ///< pixels
  int height = 1;
  PunctualLight punctual;                         ///< lights the scene if `environment` is null
  std::shared_ptr<const PackedLight> environment; ///< distant light
  Eigen::Matrix3f to_world = Eigen::Matrix3f::Identity(); ///< from the environment's frame
  bool background = true; ///< the environment is visible where no object is
  /// Environment: a square of the light is split while its estimated error exceeds this fraction of
  /// the pixel's value.
  float tolerance = default_tolerance;
  /// Level of the trees' averages, 0 … 13, or automatic_level; beyond a tree's own levels its full
  /// resolution. Environment: the finest level of the light's squares that is used.
  int level = automatic_level;

  bool operator==(const ViewState& other) const;
};

/// A picture that was read back.
struct DrawnFrame {
  std::vector<float> rgb; ///< linear, top row first
  double accesses = 0;    ///< to textures that hold trees, mean over the pixels that have any
};

/// A picture that is drawn from textures into a float image. Needs one current context for its
/// whole life, of OpenGL ES 3.0 that renders to float textures, or of OpenGL 3.3; expects blending
/// and the depth, stencil and scissor tests to be off.
class PictureDrawer {
public:
  /// The picture that was drawn last.
  DrawnFrame read() const;

  /// Draws the last picture, tone-mapped, into a viewport of a framebuffer.
  /// @param framebuffer GL's name of it; 0 is the window
  /// @param exposure    stops
  void show(unsigned framebuffer, const Viewport& viewport, double exposure) const;

  /// Size of all textures.
  std::size_t texture_bytes() const { return m_textures.bytes(); }

protected:
  PictureDrawer();
  /// Makes the picture of this size. @throws Error(Output) if it exceeds the limits of this GL
  void resize(int width, int height);
  /// Uploads textures and sets uniforms of programs.
  /// @throws Error(Output) if a texture exceeds the limits of this GL
  void upload(const ShaderInputs& inputs, const std::vector<const Program*>& programs);
  /// Draws with a program and waits until the GPU is done. @return milliseconds
  double draw_with(const Program& program) const;

private:
  FullScreenTriangle m_triangle;
  Program m_tone_map;
  TextureSet m_textures;
  std::optional<RenderTarget> m_target;
};

/// Pictures of a scene under a punctual light or an environment.
class SceneDrawer : public PictureDrawer {
public:
  /// @param scene needed by the constructor only
  /// @throws Error(Output) if the scene exceeds the limits of this GL
  explicit SceneDrawer(const ViewScene& scene);

  /// @return milliseconds of drawing, without the upload of a new environment
  /// @throws Error(Output) if the picture or the environment exceeds the limits of this GL
  double draw(const ViewState& state);

private:
  Program m_punctual;
  Program m_environment;
  std::optional<ViewState> m_drawn;
};

/// Pictures from transfer and a light.
class TransferDrawer : public PictureDrawer {
public:
  /// @param transfer of pack_transfer(), for a film of this size
  /// @throws Error(Output) if it exceeds the limits of this GL
  TransferDrawer(const ShaderInputs& transfer, int width, int height);

  /// Sets the light, from TransferLight::rotated(). Call before draw().
  void set_light(const ShaderInputs& light) { upload(light, {&m_relight}); }

  /// @param level of the finest coefficients of light and transfer that are used, 0 … 13
  /// @return milliseconds
  double draw(int level) const;

private:
  Program m_relight;
};

} // namespace haarlight::view
