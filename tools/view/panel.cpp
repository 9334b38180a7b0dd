#include <view/panel.h>

#include <imgui.h>

#include <array>
#include <string>
#include <utility>

namespace haarlight::view {
namespace {

void show_combo(const char* label, const std::vector<std::string>& names, int& chosen) {
  const auto name = [&](int i) { return names[static_cast<std::size_t>(i)].c_str(); };
  if (!ImGui::BeginCombo(label, name(chosen)))
    return;
  for (int i = 0; i < static_cast<int>(names.size()); ++i) {
    ImGui::PushID(i);
    if (ImGui::Selectable(name(i), i == chosen))
      chosen = i;
    ImGui::PopID();
  }
  ImGui::EndCombo();
}

void show_light_controls(const PanelContents& contents, Settings& settings) {
  show_combo("light", contents.lights, settings.light);
  ImGui::SliderFloat("light yaw", &settings.light_yaw, -180, 180, "%.0f deg");
  ImGui::SliderFloat("light pitch", &settings.light_pitch, -90, 90, "%.0f deg");
  if (settings.light > 0)
    ImGui::SliderFloat("tolerance", &settings.tolerance, 1e-4F, 0.1F, "%.4f",
                       ImGuiSliderFlags_Logarithmic);
}

void show_pixel_size(int& size) {
  ImGui::TextUnformatted("pixels");
  const std::array<std::pair<const char*, int>, 3> choices = {{{"1:1", 1}, {"2:1", 2}, {"4:1", 4}}};
  for (const auto& [label, value] : choices) {
    ImGui::SameLine();
    ImGui::RadioButton(label, &size, value);
  }
}

void show_statistics(const std::vector<PaneStatistics>& panes) {
  if (!ImGui::BeginTable("figures", 4, ImGuiTableFlags_BordersInnerH))
    return;
  ImGui::TableSetupColumn("file", ImGuiTableColumnFlags_WidthStretch);
  for (const char* name : {"reads/px", "ms", "MiB"})
    ImGui::TableSetupColumn(name, ImGuiTableColumnFlags_WidthFixed, 56);
  ImGui::TableHeadersRow();
  for (const PaneStatistics& pane : panes) {
    ImGui::TableNextColumn();
    ImGui::TextUnformatted(pane.name.c_str());
    ImGui::TableNextColumn();
    ImGui::Text("%.1f", pane.accesses);
    ImGui::TableNextColumn();
    ImGui::Text(pane.milliseconds < 1000 ? "%.1f" : "%.0f", pane.milliseconds);
    ImGui::TableNextColumn();
    ImGui::Text("%.1f", static_cast<double>(pane.texture_bytes) / (1 << 20));
  }
  ImGui::EndTable();
}

void show_message(const PanelContents& contents) {
  if (contents.message.empty())
    return;
  const ImVec4 colour = contents.is_error ? ImVec4(1, 0.5F, 0.4F, 1) : ImVec4(0.5F, 0.9F, 0.5F, 1);
  ImGui::PushStyleColor(ImGuiCol_Text, colour);
  ImGui::TextWrapped("%s", contents.message.c_str());
  ImGui::PopStyleColor();
}

} // namespace

void begin_panel(int flags) {
  ImGui::SetNextWindowPos(ImVec2(8, 8), ImGuiCond_FirstUseEver);
  ImGui::Begin("haarview", nullptr, flags);
}

void show_panel(const PanelContents& contents, Settings& settings) {
  ImGui::SetNextWindowSize(ImVec2(300, 0));
  ImGui::SetNextWindowBgAlpha(0.8F);
  begin_panel(ImGuiWindowFlags_NoResize);
  ImGui::PushItemWidth(200);
  show_combo("material", contents.materials, settings.material);
  show_combo("beside", contents.others, settings.second);
  ImGui::SliderFloat("exposure", &settings.exposure, -10, 10, "%+.1f stops");
  ImGui::SliderInt("level", &settings.level, -1, contents.levels,
                   settings.level < 0 ? "as needed" : "%d");
  show_light_controls(contents, settings);
  show_pixel_size(settings.min_pixel_size);
  ImGui::PopItemWidth();
  show_statistics(contents.panes);
  show_message(contents);
  ImGui::TextDisabled("drag: orbit   right drag: light");
  ImGui::TextDisabled("wheel: zoom   R: reset   Tab: panel");
  ImGui::End();
}

void show_pane_names(const std::vector<PaneStatistics>& panes, int width) {
  ImDrawList* const list = ImGui::GetBackgroundDrawList();
  const float pane_width = static_cast<float>(width) / static_cast<float>(panes.size());
  const float bottom = ImGui::GetIO().DisplaySize.y - 22;
  for (std::size_t i = 0; i < panes.size(); ++i) {
    const char* const name = panes[i].name.c_str();
    const float middle = (static_cast<float>(i) + 0.5F) * pane_width;
    const ImVec2 place(middle - ImGui::CalcTextSize(name).x / 2, bottom);
    list->AddText(ImVec2(place.x + 1, place.y + 1), IM_COL32_BLACK, name);
    list->AddText(place, IM_COL32_WHITE, name);
  }
}

} // namespace haarlight::view
