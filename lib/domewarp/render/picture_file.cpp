// SPDX-License-Identifier: Apache-2.0
#include "domewarp/render/picture_file.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <vector>

#include <unistd.h>

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <half.h>
#include <png.h>

#include "domewarp/core/errors.h"

namespace domewarp {

namespace fs = std::filesystem;

namespace {

[[noreturn]] void fail(const fs::path& path, const std::string& reason) {
  throw Error(ErrorCode::output, path.string() + ": cannot be written: " + reason);
}

bool is_exr(const fs::path& path) {
  return path.extension() == ".exr";
}

} // namespace

struct PictureFile::Writer {
  virtual ~Writer() = default;
  virtual void write(const Frame& rows) = 0;
  virtual void finish() = 0; ///< everything reaches the file
};

/// libpng reports errors by jumping; no object with a destructor may live across its calls.
struct PictureFile::PngWriter : Writer {
  fs::path path;
  std::FILE* file = nullptr;
  png_structp png = nullptr;
  png_infop info = nullptr;

  PngWriter(const fs::path& name, const fs::path& temporary, int width, int height) : path(name) {
    file = std::fopen(temporary.c_str(), "wb");
    if (!file) fail(path, std::strerror(errno));
    png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
    info = png ? png_create_info_struct(png) : nullptr;
    if (!info || !begin(width, height)) {
      release();
      fail(path, "PNG refuses a picture of " + std::to_string(width) + " x " + std::to_string(height) + " pixels");
    }
  }
  ~PngWriter() override { release(); }

  void write(const Frame& rows) override {
    if (!write_rows(rows)) fail(path, std::strerror(errno));
  }

  void finish() override {
    if (!end() || std::fflush(file) != 0) fail(path, std::strerror(errno));
  }

 private:
  void release() {
    if (png) png_destroy_write_struct(&png, &info);
    if (file) std::fclose(file);
    file = nullptr;
  }

  bool begin(int width, int height) {
    if (setjmp(png_jmpbuf(png))) return false;
    png_set_user_limits(png, 0x7fffffff, 0x7fffffff);
    png_init_io(png, file);
    png_set_IHDR(png, info, static_cast<png_uint_32>(width), static_cast<png_uint_32>(height), 8, PNG_COLOR_TYPE_RGBA,
                 PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_set_sRGB(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
    // The best filter of every row costs three times the time for a tenth of the size.
    png_set_filter(png, PNG_FILTER_TYPE_BASE, PNG_FILTER_SUB);
    png_set_compression_level(png, 4);
    png_write_info(png, info);
    return true;
  }

  bool write_rows(const Frame& rows) {
    if (setjmp(png_jmpbuf(png))) return false;
    for (int y = 0; y < rows.height; ++y)
      png_write_row(png, &rows.rgba[4 * std::size_t(y) * std::size_t(rows.width)]);
    return true;
  }

  bool end() {
    if (setjmp(png_jmpbuf(png))) return false;
    png_write_end(png, nullptr);
    return true;
  }
};

struct PictureFile::ExrWriter : Writer {
  fs::path path;
  std::unique_ptr<Imf::OutputFile> file;
  int next_row = 0;

  ExrWriter(const fs::path& name, const fs::path& temporary, int width, int height) : path(name) {
    Imf::Header header(width, height);
    header.compression() = Imf::ZIP_COMPRESSION;
    for (const char* channel : {"R", "G", "B", "A"}) header.channels().insert(channel, Imf::Channel(Imf::HALF));
    for (const char* channel : {"Z", "P.X", "P.Y", "P.Z", "N.X", "N.Y", "N.Z", "UV.U", "UV.V"})
      header.channels().insert(channel, Imf::Channel(Imf::FLOAT));
    for (const char* channel : {"objectId", "triangleId"})
      header.channels().insert(channel, Imf::Channel(Imf::UINT));
    try {
      file = std::make_unique<Imf::OutputFile>(temporary.c_str(), header);
    } catch (const std::exception& error) {
      fail(path, error.what());
    }
  }

  void write(const Frame& rows) override {
    std::vector<half> light;
    light.reserve(4 * rows.light.size());
    for (const Vec4f& v : rows.light) light.insert(light.end(), {half(v.x), half(v.y), half(v.z), half(v.w)});
    Imf::FrameBuffer buffer;
    const auto insert = [&](const char* channel, Imf::PixelType type, const void* first, std::size_t stride) {
      // OpenEXR addresses a pixel by base + y * row stride with y counted in the whole picture.
      const std::size_t row = stride * std::size_t(rows.width);
      char* base = static_cast<char*>(const_cast<void*>(first)) - std::ptrdiff_t(row) * next_row;
      buffer.insert(channel, Imf::Slice(type, base, stride, row));
    };
    const char* const colour[] = {"R", "G", "B", "A"};
    for (std::size_t i = 0; i < 4; ++i) insert(colour[i], Imf::HALF, &light[i], 4 * sizeof(half));
    insert("Z", Imf::FLOAT, rows.depth.data(), sizeof(float));
    const char* const position[] = {"P.X", "P.Y", "P.Z"};
    const char* const normal[] = {"N.X", "N.Y", "N.Z"};
    for (int i = 0; i < 3; ++i) {
      insert(position[i], Imf::FLOAT, &rows.position[0][i], sizeof(Vec3f));
      insert(normal[i], Imf::FLOAT, &rows.normal[0][i], sizeof(Vec3f));
    }
    insert("UV.U", Imf::FLOAT, &rows.uv[0].x, sizeof(Vec2f));
    insert("UV.V", Imf::FLOAT, &rows.uv[0].y, sizeof(Vec2f));
    insert("objectId", Imf::UINT, rows.object.data(), sizeof(std::uint32_t));
    insert("triangleId", Imf::UINT, rows.triangle.data(), sizeof(std::uint32_t));
    try {
      file->setFrameBuffer(buffer);
      file->writePixels(rows.height);
    } catch (const std::exception& error) {
      fail(path, error.what());
    }
    next_row += rows.height;
  }

  void finish() override { file.reset(); }
};

PictureFile::PictureFile(const fs::path& path, int width, int height)
    : path_(path), temporary_(path.string() + ".part" + std::to_string(::getpid())) {
  if (is_exr(path))
    writer_ = std::make_unique<ExrWriter>(path, temporary_, width, height);
  else if (path.extension() == ".png")
    writer_ = std::make_unique<PngWriter>(path, temporary_, width, height);
  else
    throw Error(ErrorCode::usage, path.string() + ": a picture's name ends in .png or .exr");
}

PictureFile::~PictureFile() {
  writer_.reset();
  std::error_code ignored;
  if (!finished_) fs::remove(temporary_, ignored);
}

void PictureFile::write(const Frame& rows) {
  writer_->write(rows);
}

void PictureFile::finish() {
  writer_->finish();
  writer_.reset();
  std::error_code error;
  fs::rename(temporary_, path_, error);
  if (error) fail(path_, error.message());
  finished_ = true;
}

Layers layers_for(const fs::path& path) {
  return is_exr(path) ? Layers::all : Layers::colours;
}

} // namespace domewarp
