import numpy as np
import pytest

pytest.importorskip("PIL")

from PIL import Image

from ship_gym.rendering.png import save_png


def test_a_picture_of_few_colours_comes_back(tmp_path):
    picture = np.zeros((40, 60, 3), dtype=np.uint8)
    picture[:20, :30], picture[20:, 30:] = (200, 30, 10), (0, 90, 255)
    save_png(picture, tmp_path / "new" / "picture.png")
    with Image.open(tmp_path / "new" / "picture.png") as image:
        assert image.format == "PNG"
        assert (np.array(image.convert("RGB")) == picture).all()


def test_no_half_file_is_left(tmp_path):
    with pytest.raises(TypeError):
        save_png(np.zeros((4, 4, 3), dtype=complex), tmp_path / "picture.png")
    assert not list(tmp_path.iterdir())
