#include "server/sensing/read_picture.h"

#include <png.h>

#include <csetjmp>
#include <cstdio>
// After <cstdio>, which it needs.
#include <jpeglib.h>

namespace visum::sensing {
namespace {

bool too_large(std::uint64_t width, std::uint64_t height, int max_side, int max_pixels) {
  const auto side = static_cast<std::uint64_t>(max_side), pixels = static_cast<std::uint64_t>(max_pixels);
  return width == 0 || height == 0 || width > side || height > side || width * height > pixels;
}

std::string size_fault(std::uint64_t width, std::uint64_t height, int max_pixels) {
  return "it has " + std::to_string(width) + " x " + std::to_string(height) + " pixels; " +
         std::to_string(max_pixels) + " are the most";
}

std::string read_png(const std::string& bytes, int max_side, int max_pixels, Picture& picture) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  if (!png_image_begin_read_from_memory(&image, bytes.data(), bytes.size())) return image.message;
  if (too_large(image.width, image.height, max_side, max_pixels)) {
    png_image_free(&image);
    return size_fault(image.width, image.height, max_pixels);
  }
  image.format = PNG_FORMAT_RGBA;
  std::vector<std::uint8_t> rgba(PNG_IMAGE_SIZE(image));
  if (!png_image_finish_read(&image, nullptr, rgba.data(), 0, nullptr)) return image.message;
  picture.width = static_cast<int>(image.width);
  picture.height = static_cast<int>(image.height);
  picture.rgb.resize(rgba.size() / 4 * 3);
  for (std::size_t i = 0; i < rgba.size() / 4; ++i)
    for (std::size_t channel = 0; channel < 3; ++channel)
      picture.rgb[3 * i + channel] = rgba[4 * i + channel];
  return {};
}

// libjpeg reports an error through a callback that must not return, so the callback jumps out (longjmp). The
// jump runs no destructors. Therefore everything that is made on the way lives in this struct, outside of the
// jump.
struct JpegJob {
  jpeg_decompress_struct jpeg{};
  jpeg_error_mgr errors{};
  jpeg_progress_mgr progress{};
  std::jmp_buf out;
  char message[JMSG_LENGTH_MAX] = {};
};

void leave(j_common_ptr jpeg) {
  auto& job = *static_cast<JpegJob*>(jpeg->client_data);
  job.errors.format_message(jpeg, job.message);
  std::longjmp(job.out, 1);
}

// Treats a warning as an error: libjpeg has left something out, or made it up.
void warn(j_common_ptr jpeg, int level) {
  if (level < 0) leave(jpeg);
}

// Ends a progressive picture with too many scans: each takes as long as a whole usual picture.
void watch_scans(j_common_ptr jpeg) {
  auto& job = *static_cast<JpegJob*>(jpeg->client_data);
  if (job.jpeg.input_scan_number <= kMaxScans) return;
  std::snprintf(job.message, sizeof job.message, "it has more than %d scans", kMaxScans);
  std::longjmp(job.out, 1);
}

bool begin_jpeg(JpegJob& job, const std::string& bytes) {
  job.jpeg.err = jpeg_std_error(&job.errors);
  job.errors.error_exit = leave;
  job.errors.emit_message = warn;
  job.jpeg.client_data = &job;
  if (setjmp(job.out) != 0) return false;
  jpeg_create_decompress(&job.jpeg);
  job.progress.progress_monitor = watch_scans;
  job.jpeg.progress = &job.progress;
  jpeg_mem_src(&job.jpeg, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
  jpeg_read_header(&job.jpeg, TRUE);
  return true;
}

bool finish_jpeg(JpegJob& job, std::vector<std::uint8_t>& rgb) {
  if (setjmp(job.out) != 0) return false;
  job.jpeg.out_color_space = JCS_RGB;
  job.jpeg.dct_method = JDCT_ISLOW;  // whole numbers: the same on every processor
  jpeg_start_decompress(&job.jpeg);
  while (job.jpeg.output_scanline < job.jpeg.output_height) {
    JSAMPROW row = &rgb[std::size_t{3} * job.jpeg.output_scanline * job.jpeg.output_width];
    jpeg_read_scanlines(&job.jpeg, &row, 1);
  }
  jpeg_finish_decompress(&job.jpeg);
  return true;
}

std::string read_jpeg(const std::string& bytes, int max_side, int max_pixels, Picture& picture) {
  JpegJob job;
  std::string fault;
  if (!begin_jpeg(job, bytes)) {
    fault = job.message;
  } else if (too_large(job.jpeg.image_width, job.jpeg.image_height, max_side, max_pixels)) {
    fault = size_fault(job.jpeg.image_width, job.jpeg.image_height, max_pixels);
  } else {
    picture.width = static_cast<int>(job.jpeg.image_width);
    picture.height = static_cast<int>(job.jpeg.image_height);
    picture.rgb.resize(std::size_t{3} * job.jpeg.image_width * job.jpeg.image_height);
    if (!finish_jpeg(job, picture.rgb)) fault = job.message;
  }
  jpeg_destroy_decompress(&job.jpeg);
  return fault;
}

}  // namespace

std::string read_picture(const std::string& content_type, const std::string& bytes, int max_side,
                         int max_pixels, Picture& picture) {
  return content_type == "image/png" ? read_png(bytes, max_side, max_pixels, picture)
                                     : read_jpeg(bytes, max_side, max_pixels, picture);
}

}  // namespace visum::sensing
